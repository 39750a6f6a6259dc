// Plays random worlds: a plant and its history, both built from one number. See "A world" in tests/README.md.
//     EX9000_SEED           of the first world; each further one adds 1; default 1
//     EX9000_WORLDS         how many; default 3
//     EX9000_WORLD_SECONDS  plays worlds for this processor time instead
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <ctime>

#include "firmware/expect.hpp"
#include "tests/support/environment.hpp"
#include "tests/world/generator.hpp"

namespace ex9000::world {
namespace {

constexpr std::size_t kSteps = 400;

std::string objection_to(const Setup& setup, const std::vector<Step>& steps) {
  Plant plant(setup);
  for (const Step& step : steps) {
    plant.play(step);
  }
  return plant.objection();
}

/// A history that shows an objection.
struct Finding {
  Setup setup;
  std::vector<Step> steps;

  /// Takes a shorter history, if it shows an objection too.
  bool takes(Setup fewer_modules, std::vector<Step> fewer_steps) {
    const bool objects = !objection_to(fewer_modules, fewer_steps).empty();
    if (objects) {
      setup = std::move(fewer_modules);
      steps = std::move(fewer_steps);
    }
    return objects;
  }
  bool takes(std::vector<Step> fewer) { return takes(setup, std::move(fewer)); }
};

void remove_steps(Finding& finding) {
  for (std::size_t size = finding.steps.size() / 2; size != 0; size /= 2) {
    for (std::size_t at = 0; at + size <= finding.steps.size();) {
      std::vector<Step> fewer = finding.steps;
      const auto from = fewer.begin() + static_cast<std::ptrdiff_t>(at);
      fewer.erase(from, from + static_cast<std::ptrdiff_t>(size));
      at += finding.takes(std::move(fewer)) ? 0 : size;
    }
  }
}

void remove_modules(Finding& finding) {
  for (std::size_t module = finding.setup.members.size(); module-- != 0;) {
    Setup setup = finding.setup;
    setup.members.erase(setup.members.begin() + static_cast<std::ptrdiff_t>(module));
    std::vector<Step> steps;
    for (Step step : finding.steps) {
      std::size_t* const its = module_of(step);
      if (its == nullptr || *its != module) {
        if (its != nullptr && *its > module) {
          --*its;
        }
        steps.push_back(step);
      }
    }
    if (!setup.members.empty()) {
      finding.takes(std::move(setup), std::move(steps));
    }
  }
}

void join_waits(Finding& finding) {
  for (std::size_t at = 0; at + 1 < finding.steps.size();) {
    const Wait* const first = std::get_if<Wait>(&finding.steps[at]);
    const Wait* const second = std::get_if<Wait>(&finding.steps[at + 1]);
    bool joined = false;
    if (first != nullptr && second != nullptr) {
      std::vector<Step> fewer = finding.steps;
      fewer[at] = Wait{first->time + second->time};
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(at) + 1);
      joined = finding.takes(std::move(fewer));
    }
    at += joined ? 0 : 1;
  }
}

struct Figures {
  unsigned long long worlds = 0;
  unsigned long long given_up = 0;
  unsigned long long requests = 0;
  unsigned long long replies = 0;
  std::size_t widest = 0;
  Time line_time{0};
  Plant::Updates updates{};
};

/// Returns what the specification forbids; empty if there is nothing.
std::string play(std::uint64_t seed, const Requests& requests, Figures& figures) {
  Generator generator(seed, requests);
  const Setup& setup = generator.setup();
  Plant plant(setup);
  std::vector<Step> steps;
  for (std::size_t i = 0; i < plant.size(); ++i) {
    steps.emplace_back(Power{i, true});
  }
  for (std::size_t i = 0; i < kSteps && plant.objection().empty() && !plant.gave_up(); ++i) {
    if (i == steps.size()) {
      steps.push_back(generator.next(plant));
    }
    plant.play(steps[i]);
  }
  ++figures.worlds;
  figures.given_up += plant.gave_up() ? 1 : 0;
  figures.requests += plant.requests();
  figures.replies += plant.replies();
  figures.widest = std::max(figures.widest, plant.widest());
  for (std::size_t state = 0; state < figures.updates.size(); ++state) {
    figures.updates[state] += plant.updates()[state];
  }
  figures.line_time += plant.now() - setup.begins;
  if (plant.objection().empty()) {
    return "";
  }
  Finding finding{setup, steps};
  remove_steps(finding);
  remove_modules(finding);
  join_waits(finding);
  std::string text = "tests/world/run " + std::to_string(seed) + " 1 repeats this\n" + text_of(finding.setup);
  for (const Step& step : finding.steps) {
    text += text_of(step) + "\n";
  }
  return text + objection_to(finding.setup, finding.steps);
}

TEST(World, DoesNothingThatTheSpecificationForbids) {
  const unsigned long long first = number_in_environment("EX9000_SEED", 1);
  const std::uint64_t worlds = number_in_environment("EX9000_WORLDS", 3);
  const std::uint64_t seconds = number_in_environment("EX9000_WORLD_SECONDS", 0);
  const Requests requests;
  Figures figures;
  const auto goes_on = [&] {
    return seconds == 0 ? figures.worlds < worlds
                        : static_cast<std::uint64_t>(std::clock()) / CLOCKS_PER_SEC < seconds;
  };
  while (goes_on()) {
    const std::string finding = play(first + figures.worlds, requests, figures);
    ASSERT_TRUE(finding.empty()) << finding;
  }
  std::printf(
      "%llu worlds from seed %llu on, %.1f hours of lines, %llu requests, %llu replies; "
      "at most %zu states of a module; %llu worlds given up\n",
      figures.worlds, first, std::chrono::duration<double, std::ratio<3600>>(figures.line_time).count(),
      figures.requests, figures.replies, figures.widest, figures.given_up);
  const auto begun = [&figures](reference::UpdateState state) {
    return static_cast<unsigned long long>(figures.updates[static_cast<std::size_t>(state)]);
  };
  using State = reference::UpdateState;
  std::printf(
      "updates: %llu times receiving, %llu complete, %llu not confirmed, %llu taken back, %llu over\n",
      begun(State::Receiving), begun(State::Complete), begun(State::Unconfirmed), begun(State::TakenBack),
      begun(State::None));
  if (figures.worlds >= 300) {
    for (const State state : {State::Complete, State::Unconfirmed, State::TakenBack, State::Failed}) {
      EXPECT_NE(begun(state), 0U);
    }
  }
#ifdef EX9000_CHECKED
  for (const Expectation* each = Expectation::first(); each != nullptr && figures.worlds >= 300;
       each = each->next()) {
    EXPECT_TRUE(each->reached()) << "never reached: " << each->where();
  }
#endif
  EXPECT_LE(figures.given_up, 1 + figures.worlds / 10);
}

}  // namespace
}  // namespace ex9000::world
