// Plays random sessions on the firmware and on the reference, an independent model of a module. Also replays
// the transcripts of sessions. These environment variables apply only to the first two tests:
//   EX9000_TRANSACTIONS  minimum number of requests; default 200000, or 50000 without extensions; tests/long
//                        uses 10000000
//   EX9000_SEED          seed of the first session, default 9042; each further session adds 1 to the seed
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "sim/app/play/player.hpp"
#include "tests/oracles/reference/generator.hpp"
#include "tests/oracles/reference/rules.hpp"
#include "tests/oracles/reference/session.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/transcripts.hpp"

namespace ex9000::reference {
namespace {

/// The number of steps of a session; the test of the transcripts plays a third of this number. The number is
/// large so that one step can influence many later steps.
constexpr unsigned kSteps = 300;

/// Returns the rows of the models: once if a model has one protocol, three times if it has two protocols.
/// Without extensions, omits the additional models (ModelRow::extension).
std::vector<const ModelRow*> rows_of(Extensions extensions) {
  std::vector<const ModelRow*> rows;
  for (const ModelRow& row : kModelRows) {
    if (!row.extension || extensions == Extensions::Present) {
      rows.insert(rows.end(), row.both_protocols ? 3 : 1, &row);
    }
  }
  return rows;
}

/// Returns the model for a seed. Consecutive seeds give consecutive rows of `rows_of`; the first row follows
/// the last row.
const ModelRow& row_of(std::uint64_t seed, Extensions extensions) {
  const std::vector<const ModelRow*> rows = rows_of(extensions);
  return *rows[seed % rows.size()];
}

/// A session of `length` steps. It ends earlier if the firmware and the reference differ after a step.
struct Played {
  Played(std::uint64_t seed, unsigned length, Extensions extensions)
      : row(row_of(seed, extensions)), session(row, extensions) {
    Random random(seed);
    steps = first_steps(session.reference(), random);
    for (std::size_t at = 0; alike && at < length; ++at) {
      if (at == steps.size()) {
        steps.push_back(next_step(session.reference(), random));
      }
      alike = session.play(steps[at]);
    }
  }

  const ModelRow& row;
  Session session;
  std::vector<Step> steps;
  bool alike = true;
};

/// Plays sessions until at least `wanted` requests have been sent. Fails if the firmware and the reference
/// differ, if a rule of the list in `Rules` is never reached, or if too few requests are sent shortly before
/// an expiry of the host watchdog or while the expiry is being stored.
void play_sessions(std::uint64_t wanted, Extensions extensions) {
  std::uint64_t seed = number_in_environment("EX9000_SEED", 9042);
  std::uint64_t transactions = 0;
  std::uint64_t left_open = 0;
  std::uint64_t before_expiry = 0;
  std::uint64_t behind_expiry = 0;
  std::uint64_t sessions = 0;
  Rules rules(extensions);
  for (; transactions < wanted; ++seed, ++sessions) {
    const Played played(seed, kSteps, extensions);
    ASSERT_TRUE(played.alike) << "seed " << seed << "\n"
                              << transcript_of(played.row, shrink(played.row, played.steps, extensions),
                                               extensions);
    transactions += played.session.transactions();
    left_open += played.session.left_open();
    before_expiry += played.session.before_expiry();
    behind_expiry += played.session.behind_expiry();
    for (const std::string& rule : played.session.rules()) {
      rules.reached(rule);
    }
  }
  if (std::getenv("EX9000_TRANSACTIONS") != nullptr) {
    std::printf("%s", rules.table().c_str());
  }
  for (const std::string& rule : rules.missing()) {
    ADD_FAILURE() << rule << " was never reached";
  }
  std::printf(
      "reference%s: %llu transactions in %llu sessions, %zu of %zu rules reached; %llu requests less than "
      "0.1 s before an expiry, %llu while an expiry was being stored; %llu requests omitted\n",
      extensions == Extensions::Absent ? " without extensions" : "",
      static_cast<unsigned long long>(transactions), static_cast<unsigned long long>(sessions),
      rules.size() - rules.missing().size(), rules.size(), static_cast<unsigned long long>(before_expiry),
      static_cast<unsigned long long>(behind_expiry), static_cast<unsigned long long>(left_open));
  EXPECT_GT(before_expiry, wanted / 1000);
  EXPECT_GT(behind_expiry, wanted / 1000);
}

TEST(RandomSessions, TheFirmwareBehavesLikeTheReference) {
  play_sessions(number_in_environment("EX9000_TRANSACTIONS", 200'000), Extensions::Present);
}

/// While the settings of the extensions have their factory values, a module replies to the requests of the
/// manuals as if it had no extensions. The reference has no extensions here, and `Rules` throws if a rule of
/// an extension is reached.
TEST(RandomSessions, RequestsOfTheManualsGetTheRepliesOfAModuleWithoutExtensions) {
  play_sessions(number_in_environment("EX9000_TRANSACTIONS", 50'000), Extensions::Absent);
}

TEST(RandomSessions, CanBeReplayedByTheRunnerFromTheirTranscript) {
  const system::Directory directory;
  const std::string path = directory / "session.txt";
  for (std::uint64_t seed = 0; seed < rows_of(Extensions::Present).size(); ++seed) {
    const Played played(seed, kSteps / 3, Extensions::Present);
    ASSERT_TRUE(played.alike) << played.session.transcript();
    system::write_file(path, played.session.transcript());
    for (const play::Transcript& transcript : runner::load_transcripts(path)) {
      runner::CoreTarget target;
      const play::Result result = play::play(transcript, target);
      EXPECT_TRUE(result.passed()) << "seed " << seed << ": " << result.failure << "\n"
                                   << played.session.transcript();
      EXPECT_GT(result.steps, kSteps / 3);
    }
  }
}

}  // namespace
}  // namespace ex9000::reference
