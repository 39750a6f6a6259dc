#include "sim/notation/fault_notation.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <iomanip>
#include <limits>
#include <sstream>

#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

/// The duration of a power cut without `for`.
constexpr VirtualTime kPowerCutLasts = std::chrono::seconds(1);

std::uint64_t parse_count(const std::string& word) {
  return parse_whole_number(word, 1, std::numeric_limits<std::uint64_t>::max());
}

struct Row {
  std::string_view name;
  std::string_view value;  ///< name of the fault's value in the help text; empty: the fault has no value
  std::string_view usual;  ///< a typical value, a typical schedule, or both; may be empty
  Trouble trouble;
  bool of_a_module;
  void (*take)(Fault& fault, const std::string& word);  ///< parses the value; null if there is none
  std::string_view does;
};

void take_probability(Fault& fault, const std::string& word) { fault.probability = parse_probability(word); }
void take_time(Fault& fault, const std::string& word) { fault.time = parse_time(word); }
/// Requires at least 1 ms, because an echo with a shorter delay could keep an instant line busy all the time.
void take_silence(Fault& fault, const std::string& word) {
  fault.time = parse_time(word);
  if (fault.time < std::chrono::milliseconds(1)) {
    fail("'" + word + "': expected a duration of at least 1ms");
  }
}
void take_rate(Fault& fault, const std::string& word) { fault.baud = parse_baud_rate(word); }
void take_bytes(Fault& fault, const std::string& word) { fault.bytes = parse_hex_bytes(word); }

constexpr std::array<Row, 13> kRows{{
    {"bit-errors", "P", "1e-4", Trouble::BitErrors, false, take_probability,
     "inverts each bit with this probability"},
    {"lost-bytes", "P", "0.01", Trouble::LostBytes, false, take_probability,
     "drops each byte with this probability"},
    {"inserted-bytes", "P", "0.01", Trouble::InsertedBytes, false, take_probability,
     "after each byte, adds a random byte with this probability"},
    {"stray-zeros", "P", "0.01", Trouble::StrayZeros, false, take_probability,
     "after each byte, adds the byte 00 with this probability"},
    {"echo", "TIME", "5ms", Trouble::Echo, false, take_silence,
     "sends received bytes again after a pause of this length"},
    {"foreign-traffic", "HEX", "0501000000083C48 every 1s", Trouble::ForeignTraffic, false, take_bytes,
     "makes a foreign sender send these bytes"},
    {"lost-reply", "", "every 3rd reply", Trouble::LostReply, true, nullptr, "drops the reply"},
    {"late-reply", "TIME", "50ms", Trouble::LateReply, true, take_time, "delays the reply by this time"},
    {"late-driver", "TIME", "2ms", Trouble::LateDriver, true, take_time,
     "keeps the driver enabled for this time after the reply"},
    {"wrong-rate", "RATE", "19200", Trouble::WrongRate, true, take_rate,
     "makes the module receive and send at this rate"},
    {"gone", "", "", Trouble::Gone, true, nullptr, "switches the supply off until the fault ends"},
    {"power-cut", "", "every 10s", Trouble::PowerCut, true, nullptr, "cuts the supply, for 1s by default"},
    {"hang", "", "every 10s", Trouble::Hang, true, nullptr,
     "stops the main loop until the module watchdog resets the module"},
}};

const Row& row_called(const std::string& name) {
  const auto* const row =
      std::find_if(kRows.begin(), kRows.end(), [&](const Row& known) { return known.name == name; });
  if (row == kRows.end()) {
    fail("'" + name + "' is not a fault; expected one of " + names_of(kRows));
  }
  return *row;
}

/// Returns the number of an ordinal, for example 10 for `10th`; nullopt for 0 and for any other word.
std::optional<std::uint64_t> ordinal(const std::string& word) {
  constexpr std::size_t kSuffix = 2;
  if (word.size() <= kSuffix) {
    return std::nullopt;
  }
  const std::string suffix = word.substr(word.size() - kSuffix);
  if (suffix != "st" && suffix != "nd" && suffix != "rd" && suffix != "th") {
    return std::nullopt;
  }
  const auto value =
      whole_number(word.substr(0, word.size() - kSuffix), std::numeric_limits<std::uint64_t>::max());
  return value == std::uint64_t{0} ? std::nullopt : value;
}

/// Parses the words of a schedule, from the word at the position `first` on. `words` must outlive this
/// object.
class ScheduleReader {
 public:
  ScheduleReader(const Words& words, std::size_t first) : words_(words), at_(first) {}

  Schedule read() {
    while (!done()) {
      const std::string word = next("a schedule");
      if (word == "for") {
        if (schedule_.lasts) {
          fail("'for' is given twice; leave out one of them");
        }
        schedule_.lasts = parse_time(next("a duration after 'for'"));
      } else {
        if (schedule_.when != Schedule::When::Always) {
          fail("'" + word + "': the fault already has a schedule; leave out one schedule");
        }
        read_when(word);
      }
    }
    return schedule_;
  }

 private:
  void read_when(const std::string& word) {
    if (word == "at") {
      schedule_.when = Schedule::When::At;
      schedule_.time = parse_time(next("a time after 'at'"));
    } else if (word == "every") {
      read_period(next("'reply', '10th reply' or a duration after 'every'"));
    } else if (word == "with") {
      expect("probability");
      schedule_.when = Schedule::When::Probably;
      schedule_.probability = parse_probability(next("a number after 'with probability'"));
    } else if (word == "after") {
      schedule_.when = Schedule::When::AfterWrites;
      schedule_.count = parse_count(next("a count after 'after'"));
      expect(schedule_.count == 1 ? "write" : "writes");
    } else {
      fail("'" + word +
           "' is not a schedule; expected 'at 12.5s', 'every 5s', 'every 10th reply', "
           "'with probability 0.01', 'after 3 writes' or 'for 2s'");
    }
  }

  void read_period(const std::string& word) {
    if (word == "reply") {
      schedule_.when = Schedule::When::EveryReply;
    } else if (const auto count = ordinal(word)) {
      schedule_.when = Schedule::When::EveryReply;
      schedule_.count = *count;
      expect("reply");
    } else {
      schedule_.when = Schedule::When::EveryTime;
      schedule_.time = parse_time(word);
      if (schedule_.time < std::chrono::milliseconds(1)) {
        fail("'every " + word + "': expected a period of at least 1ms");
      }
    }
  }

  void expect(const std::string& wanted) {
    const std::string word = next("'" + wanted + "'");
    if (word != wanted) {
      fail("'" + word + "': expected '" + wanted + "'");
    }
  }

  std::string next(const std::string& wanted) {
    if (done()) {
      fail("ends too early; expected " + wanted);
    }
    return words_[at_++];
  }

  [[nodiscard]] bool done() const { return at_ == words_.size(); }

  const Words& words_;
  std::size_t at_;
  Schedule schedule_;
};

/// Rejects a schedule that requires a duration and has none, a duration that is not shorter than the period,
/// and a duration that has no effect.
void check(const Fault& fault) {
  const Schedule& schedule = fault.schedule;
  const bool is_periodic = schedule.when == Schedule::When::EveryTime;
  const bool is_a_moment = fault.trouble == Trouble::ForeignTraffic || fault.trouble == Trouble::Hang;
  const bool is_a_power_cut = fault.trouble == Trouble::PowerCut;
  const bool outlasts_a_reply = fault.trouble == Trouble::Gone || fault.trouble == Trouble::WrongRate;
  const bool requires_end =
      (is_periodic && !is_a_moment && !is_a_power_cut) || (schedule.of_replies() && outlasts_a_reply);
  if (requires_end && !schedule.lasts) {
    fail("has no end; add 'for TIME'");
  }
  if (is_periodic && schedule.lasts && *schedule.lasts >= schedule.time) {
    fail("the time after 'for' is not shorter than the period; expected a shorter time");
  }
  if (is_periodic && !schedule.lasts && is_a_power_cut && schedule.time <= kPowerCutLasts) {
    fail("the power cut lasts 1s, which is not shorter than the period; add 'for TIME'");
  }
  if (schedule.lasts && is_a_moment) {
    fail("'for': this fault has no duration; leave out 'for'");
  }
}

}  // namespace

bool concerns_a_module(Trouble trouble) {
  return std::any_of(kRows.begin(), kRows.end(),
                     [=](const Row& row) { return row.trouble == trouble && row.of_a_module; });
}

Fault parse_fault(const std::string& text) {
  const Words words = words_of(text);
  if (words.empty()) {
    fail("the fault is empty; expected one of " + names_of(kRows));
  }
  const Row& row = row_called(words[0]);
  Fault fault;
  fault.text = joined(words);
  with_place(fault.text + ": ", [&] {
    fault.trouble = row.trouble;
    std::size_t used = 1;
    if (row.take != nullptr) {
      if (words.size() == 1) {
        fail("has no value; add " + std::string(row.value) + " after '" + words[0] + "'");
      }
      row.take(fault, words[used++]);
    }
    fault.schedule = ScheduleReader(words, used).read();
    check(fault);
    if (fault.trouble == Trouble::PowerCut && !fault.schedule.lasts) {
      fault.schedule.lasts = kPowerCutLasts;
    }
  });
  return fault;
}

std::vector<std::string> usual_faults() {
  std::vector<std::string> faults;
  faults.reserve(kRows.size());
  for (const Row& row : kRows) {
    faults.push_back(std::string(row.name) + (row.usual.empty() ? "" : " ") + std::string(row.usual));
  }
  return faults;
}

std::string fault_help() {
  std::ostringstream text;
  for (const Row& row : kRows) {
    const std::string shape = std::string(row.name) + (row.value.empty() ? "" : " ") + std::string(row.value);
    constexpr int kColumn = 22;
    text << "  " << std::left << std::setw(kColumn) << shape << row.does << "\n";
  }
  return text.str();
}

}  // namespace ex9000::sim
