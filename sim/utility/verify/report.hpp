// The report of `ex9000 verify`: a line for each run, then the totals.
#pragma once

#include <cstddef>
#include <ostream>
#include <string>

#include "sim/app/play/player.hpp"
#include "sim/app/play/transcript.hpp"

namespace ex9000::utility {

class Report {
 public:
  explicit Report(std::ostream& out) : out_(out) {}

  /// Not about a run.
  void note(const std::string& text) { out_ << text << std::endl; }
  void played(const play::Transcript& transcript, const play::Result& result);
  /// `why`: where, and the reason.
  void not_verified(const std::string& why);
  /// `runs`: to play; fewer were played if the program was stopped.
  void totals(std::size_t runs);

  [[nodiscard]] std::size_t passed() const { return passed_; }
  [[nodiscard]] std::size_t failed() const { return failed_; }
  [[nodiscard]] std::size_t runs() const { return passed_ + failed_ + not_verified_; }

 private:
  std::ostream& out_;
  std::size_t steps_ = 0;
  std::size_t passed_ = 0;
  std::size_t failed_ = 0;
  std::size_t not_verified_ = 0;
};

/// The file and the run.
std::string title_of(const play::Transcript& transcript);

}  // namespace ex9000::utility
