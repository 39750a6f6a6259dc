#include "sim/faults/fault.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "firmware/hex.hpp"
#include "firmware/model/baud.hpp"
#include "sim/fail.hpp"
#include "sim/time_text.hpp"
#include "sim/words.hpp"

namespace ex9000::sim {

namespace {

/// A whole word that is a number, as `Number` has it.
template <class Number>
std::optional<Number> number(std::string_view word) {
  Number value{};
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  return error == std::errc() && rest == end ? std::optional(value) : std::nullopt;
}

double parse_probability(const std::string& word) {
  const auto value = number<double>(word);
  if (!value || !(*value > 0 && *value <= 1)) {
    fail("'" + word + "' is no probability; 0.01, 1e-4 and 1 are");
  }
  return *value;
}

std::uint64_t parse_count(const std::string& word) {
  const auto value = number<std::uint64_t>(word);
  if (!value || *value == 0) {
    fail("'" + word + "' is no count from 1 on");
  }
  return *value;
}

std::uint32_t parse_rate(const std::string& word) {
  const auto value = number<std::uint32_t>(word);
  if (!value || std::find(kBaudRates.begin(), kBaudRates.end(), *value) == kBaudRates.end()) {
    fail("'" + word + "' wants 1200, 2400, 4800, 9600, 19200, 38400, 57600 or 115200");
  }
  return *value;
}

std::vector<std::uint8_t> parse_bytes(const std::string& word) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < word.size(); i += 2) {
    const int byte =
        hex_byte(static_cast<std::uint8_t>(std::toupper(static_cast<unsigned char>(word[i]))),
                 static_cast<std::uint8_t>(std::toupper(static_cast<unsigned char>(word[i + 1]))));
    if (byte >= 0) {
      bytes.push_back(static_cast<std::uint8_t>(byte));
    }
  }
  if (bytes.empty() || bytes.size() * 2 != word.size()) {
    fail("'" + word + "' is no hex; pairs of digits are, such as 0501000000083C48");
  }
  return bytes;
}

struct Row {
  std::string_view name;
  std::string_view value;  ///< what its one value is; empty: it has none
  Trouble trouble;
  bool of_a_module;
  void (*take)(Fault& fault, const std::string& word);
  std::string_view does;
};

void take_nothing(Fault& /*fault*/, const std::string& /*word*/) {}
void take_probability(Fault& fault, const std::string& word) { fault.probability = parse_probability(word); }
void take_time(Fault& fault, const std::string& word) { fault.time = parse_time(word); }
/// One that answers faster than anybody can go off would keep a line without time busy for good.
void take_silence(Fault& fault, const std::string& word) {
  fault.time = parse_time(word);
  if (fault.time < std::chrono::milliseconds(1)) {
    fail("'" + word + "' is too short a silence; 1ms is the shortest");
  }
}
void take_rate(Fault& fault, const std::string& word) { fault.baud = parse_rate(word); }
void take_bytes(Fault& fault, const std::string& word) { fault.bytes = parse_bytes(word); }

constexpr std::array<Row, 13> kRows{{
    {"bit-errors", "P", Trouble::BitErrors, false, take_probability, "each bit arrives as its opposite"},
    {"lost-bytes", "P", Trouble::LostBytes, false, take_probability, "each byte is lost"},
    {"inserted-bytes", "P", Trouble::InsertedBytes, false, take_probability,
     "behind each byte: one that nobody sent"},
    {"stray-zeros", "P", Trouble::StrayZeros, false, take_probability,
     "likewise, 00, as a line's turn-around makes them"},
    {"echo", "TIME", Trouble::Echo, false, take_silence, "what was said is said again, after this silence"},
    {"foreign-traffic", "HEX", Trouble::ForeignTraffic, false, take_bytes,
     "a stranger says this, once each time"},
    {"lost-reply", "", Trouble::LostReply, true, take_nothing, "nobody hears it"},
    {"late-reply", "TIME", Trouble::LateReply, true, take_time, "it begins by so much later"},
    {"late-driver", "TIME", Trouble::LateDriver, true, take_time, "the driver goes off by so much later"},
    {"wrong-rate", "RATE", Trouble::WrongRate, true, take_rate, "it listens and sends at this rate"},
    {"gone", "", Trouble::Gone, true, take_nothing, "its supply is off, and comes back"},
    {"power-cut", "", Trouble::PowerCut, true, take_nothing,
     "its supply goes off and on, for 1s unless told"},
    {"hang", "", Trouble::Hang, true, take_nothing,
     "its main loop stops, until the module watchdog resets it"},
}};

/// In one line, whatever it was written in.
std::string text_of(const Words& words) {
  std::string text;
  for (const std::string& word : words) {
    text += (text.empty() ? "" : " ") + word;
  }
  return text;
}

std::string all_names() {
  std::string names;
  for (const Row& row : kRows) {
    names += (names.empty() ? "" : ", ") + std::string(row.name);
  }
  return names;
}

const Row& row_called(const std::string& name) {
  const auto* const row =
      std::find_if(kRows.begin(), kRows.end(), [&](const Row& known) { return known.name == name; });
  if (row == kRows.end()) {
    fail("'" + name + "' is no fault; there are " + all_names());
  }
  return *row;
}

/// `10th`: its number.
std::optional<std::uint64_t> ordinal(const std::string& word) {
  constexpr std::size_t kSuffix = 2;
  if (word.size() <= kSuffix) {
    return std::nullopt;
  }
  const std::string suffix = word.substr(word.size() - kSuffix);
  if (suffix != "st" && suffix != "nd" && suffix != "rd" && suffix != "th") {
    return std::nullopt;
  }
  const auto value = number<std::uint64_t>(std::string_view(word).substr(0, word.size() - kSuffix));
  return value == std::uint64_t{0} ? std::nullopt : value;
}

/// Reads the words of a schedule one after the other.
class ScheduleReader {
 public:
  explicit ScheduleReader(Words words) : words_(std::move(words)) {}

  Schedule read() {
    while (!done()) {
      const std::string word = next("a schedule");
      if (word == "for") {
        if (schedule_.lasts) {
          fail("'for' is given twice");
        }
        schedule_.lasts = parse_time(next("a time behind 'for'"));
      } else {
        if (schedule_.when != Schedule::When::Always) {
          fail("'" + word + "': one schedule is enough");
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
      schedule_.time = parse_time(next("a time behind 'at'"));
    } else if (word == "every") {
      read_period(next("'reply', '10th reply' or a time behind 'every'"));
    } else if (word == "with") {
      expect("probability");
      schedule_.when = Schedule::When::Probably;
      schedule_.probability = parse_probability(next("a number behind 'with probability'"));
    } else if (word == "after") {
      schedule_.when = Schedule::When::AfterWrites;
      schedule_.count = parse_count(next("a count behind 'after'"));
      expect(schedule_.count == 1 ? "write" : "writes");
    } else {
      fail("'" + word +
           "' is no schedule; there are 'at 12.5s', 'every 5s', 'every 10th reply', 'with probability 0.01', "
           "'after 3 writes', and 'for 2s'");
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
        fail("'every " + word + "' is too often; every 1ms is the most");
      }
    }
  }

  void expect(const std::string& wanted) {
    const std::string word = next("'" + wanted + "'");
    if (word != wanted) {
      fail("'" + word + "' wants to be '" + wanted + "'");
    }
  }

  std::string next(const std::string& wanted) {
    if (done()) {
      fail("wants " + wanted);
    }
    return words_[at_++];
  }

  [[nodiscard]] bool done() const { return at_ == words_.size(); }

  Words words_;
  std::size_t at_ = 0;
  Schedule schedule_;
};

/// What would mean nothing, or never end.
void check(const Fault& fault) {
  const Schedule& schedule = fault.schedule;
  const bool lasting = fault.trouble != Trouble::ForeignTraffic && fault.trouble != Trouble::Hang &&
                       fault.trouble != Trouble::PowerCut;
  if (schedule.when == Schedule::When::EveryTime && lasting && !schedule.lasts) {
    fail("lasts; add 'for TIME'");
  }
  if (schedule.when == Schedule::When::EveryTime && schedule.lasts && *schedule.lasts >= schedule.time) {
    fail("lasts longer than until the next; shorten 'for'");
  }
  if (schedule.of_replies() && (fault.trouble == Trouble::Gone || fault.trouble == Trouble::WrongRate) &&
      !schedule.lasts) {
    fail("lasts; add 'for TIME'");
  }
  if (schedule.lasts && (fault.trouble == Trouble::ForeignTraffic || fault.trouble == Trouble::Hang)) {
    fail("'for': this is over at once; leave it out");
  }
}

}  // namespace

bool befalls_a_module(Trouble trouble) {
  return std::any_of(kRows.begin(), kRows.end(),
                     [=](const Row& row) { return row.trouble == trouble && row.of_a_module; });
}

Fault parse_fault(const std::string& text) {
  Words words = words_of(text);
  if (words.empty()) {
    fail("an empty fault; there are " + all_names());
  }
  const Row& row = row_called(words[0]);
  try {
    Fault fault;
    fault.text = text_of(words);
    fault.trouble = row.trouble;
    std::size_t used = 1;
    if (!row.value.empty()) {
      if (words.size() == 1) {
        fail("wants " + std::string(row.value) + " behind it");
      }
      row.take(fault, words[used++]);
    }
    fault.schedule =
        ScheduleReader(Words(words.begin() + static_cast<std::ptrdiff_t>(used), words.end())).read();
    check(fault);
    return fault;
  } catch (const std::invalid_argument& error) {
    fail(text_of(words) + ": " + error.what());
  }
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
