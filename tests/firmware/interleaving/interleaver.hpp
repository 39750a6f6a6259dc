// Plays a scenario with its steps at each point of a turn, or at pairs of points.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/firmware/interleaving/scenario.hpp"

namespace ex9000::interleaving {

/// Counts the points and interleavings that a test has tried, so that the test can require a minimum.
struct Tried {
  unsigned points = 0;  ///< counted only by Interleaver::at_every_point
  unsigned interleavings = 0;

  void print() const { std::printf("points: %u, interleavings: %u\n", points, interleavings); }
};

/// Plays one scenario with its steps at many points, and compares each part of the outcome with the permitted
/// parts.
class Interleaver {
 public:
  Interleaver(const Scenario& scenario, Tried& counted)
      : scenario_(scenario), counted_(counted), steps_(scenario.script.size()) {
    // Collects the permitted outcomes: for each value of `before`, the outcome if this number of steps comes
    // before the turn and the other steps come after it.
    for (std::size_t before = 0; before <= steps_; ++before) {
      Places places(steps_, kAfterTheTurn);
      std::fill_n(places.begin(), before, kBeforeTheTurn);
      const Run run = tried(places);
      outcomes_.resize(std::max(outcomes_.size(), run.outcome.size()));
      for (std::size_t part = 0; part < run.outcome.size(); ++part) {
        outcomes_[part].insert(run.outcome[part]);
      }
      points_ = std::max(points_, run.points);
    }
  }

  /// For each point, tries all steps at this point. If there are several steps, also tries the first step at
  /// this point and each further step one point after the previous step.
  void at_every_point() {
    for (int point = 0; point < static_cast<int>(points_); ++point) {
      check(Places(steps_, point));
      if (steps_ > 1) {
        Places places;
        for (std::size_t i = 0; i < steps_; ++i) {
          places.push_back(point + static_cast<int>(i));
        }
        check(places);
      }
    }
    counted_.points += points_;
  }

  /// Tries `samples` random pairs of points: a random number of first steps at one point, the other steps at
  /// the same or a later point. A step may also come before or after the turn. Tries nothing if there are
  /// fewer than two steps.
  void at_pairs(std::mt19937& random, unsigned samples) {
    if (steps_ < 2) {
      return;
    }
    std::uniform_int_distribution<int> any_point(kBeforeTheTurn, static_cast<int>(points_));
    std::uniform_int_distribution<std::size_t> any_step(1, steps_ - 1);
    for (unsigned i = 0; i < samples; ++i) {
      const int first = any_point(random);
      const int second = any_point(random);
      Places places(steps_, std::max(first, second));
      std::fill_n(places.begin(), any_step(random), std::min(first, second));
      check(places);
    }
  }

  /// Tries all pairs of points: the first step at one point, the second step at the same or a later point.
  /// The script must have two steps.
  void at_all_pairs() {
    for (int first = 0; first < static_cast<int>(points_); ++first) {
      for (int second = first; second < static_cast<int>(points_); ++second) {
        check({first, second});
      }
    }
  }

 private:
  Run tried(const Places& places) {
    ++counted_.interleavings;
    try {
      return play(scenario_, places);
    } catch (const std::logic_error& error) {
      complain(error.what(), places);
      return {};
    }
  }
  void check(const Places& places) {
    const Run run = tried(places);
    for (std::size_t part = 0; part < run.outcome.size(); ++part) {
      if (outcomes_[part].count(run.outcome[part]) == 0) {
        complain("unexpected outcome: " + run.outcome[part], places);
      }
    }
  }
  void complain(const std::string& what, const Places& places) {
    constexpr unsigned kEnough = 3;
    if (complaints_++ < kEnough) {
      std::string at;
      for (const int place : places) {
        at += " " + std::to_string(place);
      }
      ADD_FAILURE() << scenario_.name << ", at" << at << ": " << what;
    }
  }

  const Scenario& scenario_;
  Tried& counted_;
  std::size_t steps_;
  unsigned points_ = 0;
  unsigned complaints_ = 0;
  std::vector<std::set<std::string>> outcomes_;
};

}  // namespace ex9000::interleaving
