#include "sim/utility/update/session.hpp"

#include <algorithm>
#include <string>

#include "sim/utility/console/progress.hpp"
#include "sim/utility/update/update.hpp"

namespace ex9000::utility {

namespace {

constexpr const char* kNothingSent = "nothing has been sent";
constexpr const char* kContinues = "the modules keep what they have received; the same command continues";
constexpr const char* kActivated = "the modules that have been activated continue without this program";

struct Part {
  ModuleUpdate update;
  std::string failure = {};  ///< empty: none so far
};

class Session {
 public:
  Session(Environment& environment, std::vector<Part>& parts) : environment_(environment), parts_(parts) {}

  /// What an error leaves behind; empty: the images run.
  [[nodiscard]] const std::string& remark() const { return remark_; }

  void run(bool wait) {
    if (!all([](ModuleUpdate& update) { update.prepare(); })) {
      return;
    }
    remark_ = kContinues;
    if (!all([this](ModuleUpdate& update) {
          Progress progress(environment_, update.name());
          update.send([&](std::uint32_t has, std::uint32_t length) { progress.show(has, length); });
        })) {
      return;
    }
    remark_ = kActivated;
    all([](ModuleUpdate& update) { update.activate(); });
    all([](ModuleUpdate& update) { update.wait_until_it_runs(); });
    if (wait) {
      all([](ModuleUpdate& update) { update.wait_until_confirmed(); });
    }
    remark_ = "";
  }

 private:
  /// Does a step of all modules that have not failed. Returns whether none has.
  template <class Step>
  bool all(Step step) {
    bool good = true;
    for (Part& part : parts_) {
      try {
        if (part.failure.empty()) {
          step(part.update);
        }
      } catch (const Failed& error) {
        part.failure = error.what();
      }
      good = good && part.failure.empty();
    }
    return good;
  }

  Environment& environment_;
  std::vector<Part>& parts_;
  std::string remark_ = kNothingSent;
};

}  // namespace

bool update_modules(Environment& environment, Master& master, const std::vector<Addressee>& modules,
                    const UpdateFile& file, bool wait) {
  std::vector<Part> parts;
  parts.reserve(modules.size());
  for (const Addressee& module : modules) {
    parts.push_back({ModuleUpdate({master, module}, file)});
  }
  Session session(environment, parts);
  try {
    session.run(wait);
  } catch (const Interrupted&) {
    environment.error << "ex9000: stopped: " << session.remark() << std::endl;
    throw;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(error.what()) + " (" + session.remark() + ")");
  }
  const std::string result =
      "runs " + file.version() + (wait ? ", confirmed" : ", which it confirms after 60 s");
  for (const Part& part : parts) {
    environment.output << part.update.name() << ": "
                       << (!part.failure.empty() ? "FAILED: " + part.failure
                           : !session.remark().empty()
                               ? "not updated, because another module has failed: " + session.remark()
                               : result)
                       << std::endl;
  }
  return std::all_of(parts.begin(), parts.end(), [](const Part& part) { return part.failure.empty(); });
}

}  // namespace ex9000::utility
