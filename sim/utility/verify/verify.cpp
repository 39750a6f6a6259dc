#include "sim/utility/verify/verify.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "sim/app/play/player.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/console/progress.hpp"
#include "sim/utility/verify/module_target.hpp"
#include "sim/utility/verify/report.hpp"

namespace ex9000::utility {

namespace {

/// Why it cannot be played on a real module; empty: perhaps it can.
std::string why_not(const play::Transcript& transcript, const Rig& rig, Time latency) {
  if (transcript.blank_memory) {
    return "requires a module that has never stored anything";
  }
  for (const std::filesystem::path& folder : std::filesystem::path(transcript.file).parent_path()) {
    if (folder == "update" || folder == "update-simulated" || folder == "no-update") {
      return "is about updates, with images that would replace those of the module";
    }
  }
  for (const play::Step& step : transcript.steps) {
    const sim::Words words = step.words();
    const bool too_short = words[0] == "wait" && sim::parse_time(words[1]) < 2 * latency;
    if (too_short || rig.never_does(words[0])) {
      return "line " + std::to_string(step.line) + ": '" + step.text + "' is " +
             (too_short ? "too short for the port" : "nothing that a person can do");
    }
  }
  return "";
}

/// With one decimal, rounded up.
std::string milliseconds_text(Time time) {
  constexpr int kTenths = 10;
  constexpr std::chrono::microseconds kTenth{100};
  const auto tenths = (time + kTenth - Time(1)) / kTenth;
  return std::to_string(tenths / kTenths) + "." + std::to_string(tenths % kTenths);
}

class Verification {
 public:
  Verification(Environment& environment, const VerifyTask& task, Rig& rig, std::ostream& out)
      : environment_(environment),
        task_(task),
        rig_(rig),
        report_(out),
        line_(environment, task.port, {9600, LineFormat::k8N1}),
        init_mode_(line_, rig),
        model_(task.model) {}

  bool run() {
    report_.note("ex9000 " + std::string(kFirmwareVersion));
    try {
      look_at_module();
    } catch (const NotVerified& error) {
      leave();
      report_.note("module: not read: " + std::string(error.what()));
      for (const play::Transcript& transcript : runs()) {
        report_.not_verified(title_of(transcript) + ": " + error.what());
      }
      report_.totals(report_.runs());
      return false;
    } catch (...) {
      leave();
      throw;
    }
    const std::vector<play::Transcript> all = runs();
    try {
      play(all);
    } catch (...) {
      restore();
      report_.totals(all.size());
      throw;
    }
    const bool restored = restore();
    report_.totals(all.size());
    return restored && report_.failed() == 0 && report_.passed() != 0;
  }

 private:
  [[nodiscard]] std::vector<play::Transcript> runs() const {
    std::vector<play::Transcript> chosen;
    std::copy_if(task_.transcripts.begin(), task_.transcripts.end(), std::back_inserter(chosen),
                 [this](const play::Transcript& each) { return each.model == model_; });
    return chosen;
  }

  /// If it is in INIT mode.
  void leave() {
    try {
      if (init_mode_.has_restarted()) {
        init_mode_.leave();
      }
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch)
      // the reason why it should leave is reported
    }
  }

  void look_at_module() {
    init_mode_.enter();
    const Nameplate plate = init_mode_.nameplate();
    const bool by_address = task_.module.by_address();
    if (by_address ? plate.address != task_.module.request[0]
                   : !plate.serial_number || sim::hex_long_text(*plate.serial_number) != task_.module.name) {
      sim::fail("the rig switches a module with address " + std::to_string(plate.address) + ", not " +
                task_.module.name);
    }
    model_ = model_ == nullptr ? plate.model : model_;
    if (model_ == nullptr) {
      sim::fail("its name '" + plate.name + "' does not say which model it is; add --model");
    }
    report_.note("module: " + std::string(model_->designation) + ", name " + plate.name + ", version " +
                 plate.version + ", serial number " +
                 (plate.serial_number ? sim::hex_long_text(*plate.serial_number) : "unknown"));
    before_ = init_mode_.read(*model_);
    if (runs().empty()) {
      sim::fail("no transcript is for " + std::string(model_->designation) + "; name others");
    }
  }

  void play(const std::vector<play::Transcript>& all) {
    latency_ = init_mode_.latency();
    report_.note("port: " + task_.port.name + ", latency " + milliseconds_text(latency_) +
                 " ms, which is the tolerance of times");
    std::optional<Progress> progress;
    if (task_.report) {
      progress.emplace(environment_, *task_.report);
    }
    ModuleTarget target(line_, rig_, before_.serial_number, latency_);
    for (const play::Transcript& transcript : all) {
      play(transcript, target);
      if (progress) {
        progress->show(report_.runs(), all.size());
      }
    }
  }

  void play(const play::Transcript& transcript, ModuleTarget& target) {
    const std::string reason = why_not(transcript, rig_, latency_);
    if (!reason.empty()) {
      report_.not_verified(title_of(transcript) + ": " + reason);
      return;
    }
    play::Result result;
    try {
      result = play::play(transcript, target);
      target.throw_problem();
    } catch (const NotVerified& error) {
      report_.not_verified(result.passed() ? title_of(transcript) + ": " + error.what() : result.failure);
      return;
    }
    report_.played(transcript, result);
  }

  void bring_back() {
    init_mode_.enter();
    init_mode_.write(*model_, before_);
    if (init_mode_.read(*model_) != before_) {
      throw std::runtime_error("the module has taken all commands, but not all settings");
    }
    init_mode_.leave();
  }

  bool restore() {
    try {
      try {
        bring_back();
      } catch (const Interrupted&) {  // begins anew; a second one gives it up
        bring_back();
      }
      report_.note("settings restored");
      return true;
    } catch (const std::exception& error) {
      report_.note("settings NOT restored: " + std::string(error.what()));
      std::string commands;
      for (const std::string& command : commands_between(*model_, Settings::factory(*model_), before_)) {
        commands += " " + command;
      }
      report_.note("in INIT mode, these commands change those of the factory to what was there:" + commands);
      leave();
      return false;
    }
  }

  Environment& environment_;
  const VerifyTask& task_;
  Rig& rig_;
  Report report_;
  MasterLine line_;
  InitMode init_mode_;
  const Model* model_;
  Settings before_;
  Time latency_{0};
};

}  // namespace

bool verify(Environment& environment, const VerifyTask& task, Rig& rig) {
  if (task.port.kind == Port::Kind::ModbusTcp) {
    sim::fail("Modbus TCP carries no DCON; name another port");
  }
  const auto scenario = std::find_if(task.transcripts.begin(), task.transcripts.end(),
                                     [](const play::Transcript& each) { return each.model == nullptr; });
  if (scenario != task.transcripts.end()) {
    sim::fail(scenario->file + ": names no model; name transcripts");
  }
  if (!task.report) {
    return Verification(environment, task, rig, environment.output).run();
  }
  std::ofstream file(*task.report);
  const bool good = file.is_open() && Verification(environment, task, rig, file).run();
  if (!file.flush()) {
    sim::unavailable("--report: " + *task.report + ": cannot be written; name another file");
  }
  environment.output << *task.report << ": " << (good ? "all passed" : "not all passed") << std::endl;
  return good;
}

}  // namespace ex9000::utility
