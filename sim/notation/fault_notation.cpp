#include "sim/notation/fault_notation.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>

#include "sim/notation/word_reader.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/help_row.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

using When = Schedule::When;
using Lasts = FaultKind::Lasts;

constexpr VirtualTime kShortestPause = std::chrono::milliseconds(1);

struct ValueNotation {
  std::string_view name;
  void (*take)(Fault& fault, const std::string& word);
};

/// In the order of FaultKind::Value.
constexpr std::array<ValueNotation, 7> kValues{{
    {"", nullptr},
    {"P", [](Fault& fault, const std::string& word) { fault.probability = parse_probability(word); }},
    {"TIME", [](Fault& fault, const std::string& word) { fault.time = parse_time(word); }},
    {"TIME",  // a shorter pause could keep an instant line busy all the time
     [](Fault& fault, const std::string& word) {
       fault.time = parse_time(word);
       if (fault.time < kShortestPause) {
         fail("'" + word + "': expected a duration of at least 1ms");
       }
     }},
    {"RATE", [](Fault& fault, const std::string& word) { fault.rate = parse_baud_rate(word); }},
    {"HH", [](Fault& fault, const std::string& word) { fault.bytes = {parse_hex_byte(word)}; }},
    {"HEX", [](Fault& fault, const std::string& word) { fault.bytes = parse_hex_bytes(word); }},
}};

const ValueNotation& value_of(const FaultKind& kind) { return kValues[static_cast<std::size_t>(kind.value)]; }

const FaultKind& read_kind(WordReader& reader) {
  const std::string name = reader.next("one of " + names_of(fault_kinds()));
  for (const FaultKind& kind : fault_kinds()) {
    if (kind.name == name) {
      return kind;
    }
  }
  fail("'" + name + "' is not a fault; expected one of " + names_of(fault_kinds()));
}

/// 10 for `10th`; 0 for any other word.
std::uint64_t ordinal(const std::string& word) {
  constexpr std::size_t kSuffix = 2;
  const std::size_t digits = std::max(word.size(), kSuffix) - kSuffix;
  const std::string suffix = word.substr(digits);
  const bool is_suffix = suffix == "st" || suffix == "nd" || suffix == "rd" || suffix == "th";
  const auto value = whole_number(word.substr(0, digits), std::numeric_limits<std::uint64_t>::max());
  return is_suffix ? value.value_or(0) : 0;
}

void read_period(WordReader& reader, Schedule& schedule) {
  const std::string word = reader.next("'reply', '10th reply' or a duration after 'every'");
  schedule.count = word == "reply" ? 1 : ordinal(word);
  if (schedule.count == 0) {
    schedule.when = When::EveryTime;
    schedule.time = parse_time(word);
    if (schedule.time < kShortestPause) {
      fail("'every " + word + "': expected a period of at least 1ms");
    }
    return;
  }
  schedule.when = When::EveryReply;
  if (word != "reply") {
    reader.expect("reply");
  }
}

void read_when(WordReader& reader, const std::string& word, Schedule& schedule) {
  if (word == "at") {
    schedule.when = When::At;
    schedule.time = parse_time(reader.next("a time after 'at'"));
  } else if (word == "every") {
    read_period(reader, schedule);
  } else if (word == "with") {
    reader.expect("probability");
    schedule.when = When::Probably;
    schedule.probability = parse_probability(reader.next("a number after 'with probability'"));
  } else if (word == "after") {
    schedule.when = When::AfterWrites;
    constexpr std::uint64_t kMostWrites = 999'999'999;
    schedule.count = parse_whole_number(reader.next("a count after 'after'"), 1, kMostWrites);
    reader.expect(schedule.count == 1 ? "write" : "writes");
  } else {
    fail("'" + word +
         "' is not a schedule; expected 'at 12.5s', 'every 5s', 'every 10th reply', "
         "'with probability 0.01', 'after 3 writes' or 'for 2s'");
  }
}

Schedule read_schedule(WordReader& reader) {
  Schedule schedule;
  while (!reader.done()) {
    const std::string word = reader.next("a schedule");
    if (word == "for" && schedule.lasts) {
      fail("'for' is given twice; leave out one of them");
    } else if (word == "for") {
      schedule.lasts = parse_time(reader.next("a duration after 'for'"));
    } else if (schedule.when != When::Always) {
      fail("'" + word + "': the fault already has a schedule; leave out one schedule");
    } else {
      read_when(reader, word, schedule);
    }
  }
  return schedule;
}

/// Rejects an impossible schedule, and a duration that is missing, without effect, or not below the period.
void check(const FaultKind& kind, const Schedule& schedule) {
  const bool is_periodic = schedule.when == When::EveryTime;
  if (kind.is_of_the_line() && schedule.of_replies()) {
    fail("a fault of the line does not depend on replies; expected a time, for example 'at 5s for 1s'");
  }
  if (kind.lasts == Lasts::Moment) {
    if (schedule.lasts) {
      fail("'for': this fault has no duration; leave out 'for'");
    }
  } else if (!schedule.lasts && (is_periodic || (schedule.of_replies() && kind.lasts == Lasts::Open))) {
    fail("has no end; add 'for TIME'");
  } else if (is_periodic && *schedule.lasts >= schedule.time) {
    fail("lasts " + time_text(*schedule.lasts) +
         ", which is not shorter than the period; expected a shorter time after 'for'");
  }
}

}  // namespace

Fault parse_fault(const std::string& text, std::optional<std::size_t> module) {
  const Words words = words_of(text);
  WordReader reader(words);
  Fault fault;
  fault.kind = &read_kind(reader);
  fault.module = module;
  fault.text = joined(words);
  with_place(fault.text + ": ", [&] {
    const ValueNotation& value = value_of(*fault.kind);
    if (value.take != nullptr) {
      value.take(fault, reader.next(std::string(value.name) + " after '" + words[0] + "'"));
    }
    fault.schedule = read_schedule(reader);
    if (fault.kind->lasts == Lasts::Second) {
      fault.schedule.lasts = fault.schedule.lasts.value_or(std::chrono::seconds(1));
    }
    check(*fault.kind, fault.schedule);
    if (module && fault.kind->is_of_the_line()) {
      fail("concerns the line, not a module; add it as a fault of the line");
    }
  });
  return fault;
}

std::vector<std::string> usual_faults() {
  std::vector<std::string> faults;
  for (const FaultKind& kind : fault_kinds()) {
    faults.push_back(std::string(kind.name) + (kind.usual.empty() ? "" : " ") + std::string(kind.usual));
  }
  return faults;
}

std::string fault_help() {
  constexpr std::size_t kColumn = 22;
  std::string text;
  for (const FaultKind& kind : fault_kinds()) {
    text += help_row(std::string(kind.name) + " " + std::string(value_of(kind).name), kind.does, kColumn);
  }
  return text;
}

}  // namespace ex9000::sim
