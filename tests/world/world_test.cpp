// Plays random worlds: a plant and its history, both built from one number. See "A world" in tests/README.md.
//     EX9000_SEED           of the first world; each further one adds 1; default 1
//     EX9000_WORLDS         how many; default 3
//     EX9000_WORLD_SECONDS  plays worlds for this processor time instead
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <ctime>

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

/// Removes what is not necessary for an objection: steps, and pauses between waits.
std::vector<Step> shrunk(const Setup& setup, std::vector<Step> steps) {
  const auto try_instead = [&](std::vector<Step> fewer) {
    const bool objects = !objection_to(setup, fewer).empty();
    if (objects) {
      steps = std::move(fewer);
    }
    return objects;
  };
  for (std::size_t size = steps.size() / 2; size != 0; size /= 2) {
    for (std::size_t at = 0; at + size <= steps.size();) {
      std::vector<Step> fewer = steps;
      const auto from = fewer.begin() + static_cast<std::ptrdiff_t>(at);
      fewer.erase(from, from + static_cast<std::ptrdiff_t>(size));
      at += try_instead(std::move(fewer)) ? 0 : size;
    }
  }
  for (std::size_t at = 0; at + 1 < steps.size();) {
    const Wait* const first = std::get_if<Wait>(&steps[at]);
    const Wait* const second = std::get_if<Wait>(&steps[at + 1]);
    bool joined = false;
    if (first != nullptr && second != nullptr) {
      std::vector<Step> fewer = steps;
      fewer[at] = Wait{first->time + second->time};
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(at) + 1);
      joined = try_instead(std::move(fewer));
    }
    at += joined ? 0 : 1;
  }
  return steps;
}

struct Figures {
  unsigned long long worlds = 0;
  unsigned long long given_up = 0;
  unsigned long long requests = 0;
  unsigned long long replies = 0;
  std::size_t widest = 0;
  Time line_time{0};
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
  figures.line_time += plant.now() - setup.begins;
  if (plant.objection().empty()) {
    return "";
  }
  const std::vector<Step> fewer = shrunk(setup, steps);
  std::string text =
      "EX9000_SEED=" + std::to_string(seed) + " EX9000_WORLDS=1 repeats this\n" + text_of(setup);
  for (const Step& step : fewer) {
    text += text_of(step) + "\n";
  }
  return text + objection_to(setup, fewer);
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
    ASSERT_EQ(play(first + figures.worlds, requests, figures), "");
  }
  std::printf(
      "%llu worlds from seed %llu on, %.1f hours of lines, %llu requests, %llu replies; "
      "at most %zu states of a module; %llu worlds given up\n",
      figures.worlds, first, std::chrono::duration<double, std::ratio<3600>>(figures.line_time).count(),
      figures.requests, figures.replies, figures.widest, figures.given_up);
  EXPECT_LE(figures.given_up, 1 + figures.worlds / 10);
}

}  // namespace
}  // namespace ex9000::world
