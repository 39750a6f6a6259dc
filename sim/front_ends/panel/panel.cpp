#include "sim/front_ends/panel/panel.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "firmware/model/model.hpp"
#include "sim/front_ends/panel/console.hpp"
#include "sim/front_ends/panel/face.hpp"
#include "sim/front_ends/panel/messages.hpp"
#include "sim/front_ends/panel/recent_traffic.hpp"
#include "sim/notation/fault_notation.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

/// Frames and notes in one message, unless kFewestFrames applies: more than two lines at 115200 baud usually
/// carry between two looks at speed 1, and too few to cause a delay that a master notices.
constexpr std::size_t kMostFrames = 250;
/// For each line, even if there are many.
constexpr std::size_t kFewestFrames = 20;

/// Actions that a page holds active; only a faulty page exceeds it.
constexpr std::size_t kMostHeld = 256;

/// Console requests of one page without an answer.
constexpr std::size_t kMostAsked = 16;

/// Without a message this often, a page could not tell an idle simulator from one that does not respond.
constexpr std::chrono::seconds kHeartbeat{1};

std::string random_id() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  constexpr std::size_t kLength = 16;
  std::random_device device;
  std::string id;
  while (id.size() < kLength) {
    id += kDigits[device() % kDigits.size()];
  }
  return id;
}

}  // namespace

/// A part of the state, and the number of the look at which it last changed. Looks are for all viewers.
struct Panel::Tracked {  // NOLINT(bugprone-exception-escape): moving a value does not throw
  Message value;
  std::uint64_t changed = 0;  ///< 0: there is no value yet

  void set(Message present, std::uint64_t look) {
    if (changed == 0 || value != present) {
      value = std::move(present);
      changed = look;
    }
  }
};

struct Panel::Module {
  std::map<std::string, Tracked> face;  ///< the parts of PanelLine::face
};

struct Panel::Watched {
  PanelLine line;
  VirtualTime now{0};            ///< the line's time at the last look
  std::size_t first_module = 0;  ///< position across all lines, from 0
  std::vector<Module> modules;
  RecentTraffic recent;
  Tracked faults;

  void capture(std::uint64_t look) {
    now = line.present();
    for (std::size_t i = 0; i < modules.size(); ++i) {
      const Message face = line.face(i);
      for (const auto& [key, part] : face.items()) {
        modules[i].face[key].set(part, look);
      }
    }
    faults.set(message_of(line.faults(), first_module), look);
  }
};

class Panel::Viewer final : public PanelViewer {
 public:
  explicit Viewer(Panel& panel) : panel_(panel) {
    for (const Watched& watched : panel_.lines_) {
      next_entries_.push_back(watched.recent.first_of(0, most_frames()));
    }
  }

  bool ask(const std::string& text) override {
    const Message message = Message::parse(text, nullptr, /*allow_exceptions=*/false);
    if (const std::optional<ConsoleRequest> request = parse_console_request(message)) {
      return ask_line(*request);
    }
    const std::optional<PageRequest> request = parse_page_request(message);
    if (!request || (!request->undo.empty() && held_.size() >= kMostHeld)) {
      return false;
    }
    const std::string answer = carry_out(request->command);
    const bool ok = answer.rfind("ok", 0) == 0;
    held_.erase(request->command);
    if (ok && !request->undo.empty()) {
      held_.insert(request->undo);
    }
    reply_ = Message{{"id", request->id}, {"ok", ok}, {"text", answer}};
    return true;
  }

  std::string next() override {
    Message message;
    if (sent_look_ == 0) {
      message["hello"] = hello();
    }
    if (reply_) {
      message["reply"] = *std::exchange(reply_, std::nullopt);
    }
    if (!answers_.empty()) {
      message["answers"] = std::exchange(answers_, Message::array());
    }
    Message modules = Message::array();
    Message lines = Message::array();
    Message frames = Message::array();
    bool news = false;
    for (std::size_t i = 0; i < panel_.lines_.size(); ++i) {
      const Watched& watched = panel_.lines_[i];
      for (std::size_t at = 0; at < watched.modules.size(); ++at) {
        Message module = news_of(watched.modules[at]);
        if (!module.is_null()) {
          module["module"] = watched.first_module + at;
          modules.push_back(std::move(module));
        }
      }
      lines.push_back(news_of(watched));
      news = news || lines.back().size() > 1;
      if (next_entries_[i] < watched.recent.end()) {
        frames.push_back(frames_of(i));
      }
    }
    const auto now = panel_.wall_clock_();
    news = news || !modules.empty() || !frames.empty() || now - last_sent_at_ >= kHeartbeat;
    if (news) {
      message["state"]["lines"] = std::move(lines);
      message["state"]["modules"] = std::move(modules);
    }
    if (!frames.empty()) {
      message["frames"] = std::move(frames);
    }
    sent_look_ = panel_.looks_;
    if (message.is_null()) {
      return "";
    }
    last_sent_at_ = now;
    return message.dump(-1, ' ', false, Message::error_handler_t::replace);
  }

  void leave() override {
    for (const std::string& undo : std::exchange(held_, {})) {
      static_cast<void>(carry_out(undo));
    }
  }

 private:
  /// The answer follows in a later message. false: the line does not exist.
  bool ask_line(const ConsoleRequest& request) {
    if (request.line >= panel_.lines_.size()) {
      return false;
    }
    if (asked_ >= kMostAsked) {
      answers_.push_back(
          rejection_of(request, "16 requests of this page have no reply yet; wait for a reply"));
      return true;
    }
    try {
      RequestQueue::Request frame = frame_of(request);
      frame.owner = lives_;
      frame.done = [lives = std::weak_ptr<Viewer*>(lives_), request](const RequestQueue::Reply& reply) {
        if (const auto viewer = lives.lock()) {
          --(*viewer)->asked_;
          (*viewer)->answers_.push_back(answer_to(request, reply));
        }
      };
      ++asked_;
      panel_.ask_(request.line, std::move(frame));
    } catch (const std::invalid_argument& error) {
      answers_.push_back(rejection_of(request, error.what()));
    }
    return true;
  }

  [[nodiscard]] std::string carry_out(const std::string& command) const {
    if (!simulated()) {
      return "error: the modules are real; send them requests";
    }
    const Words words = words_of(command);
    return !words.empty() && words[0] == "quit"
               ? "error: a page cannot end the simulator; press Ctrl-C in the terminal of the simulator"
               : panel_.carry_out_(command).text;
  }

  [[nodiscard]] bool simulated() const { return panel_.carry_out_ != nullptr; }

  [[nodiscard]] std::size_t most_frames() const {
    return std::max(kFewestFrames, kMostFrames / panel_.lines_.size());
  }

  [[nodiscard]] Message hello() const {
    Message lines = Message::array();
    Message modules = Message::array();
    for (const Watched& watched : panel_.lines_) {
      for (const Model* const model : watched.line.models) {
        modules.push_back(plate_layout(*model));
        modules.back()["line"] = lines.size();
        modules.back()["simulated"] = simulated();
      }
      Message ports = Message::array();
      for (const PortSummary& port : watched.line.summary.ports) {
        ports.push_back(port.address);
      }
      lines.push_back({{"name", watched.line.summary.name}, {"ports", std::move(ports)}});
    }
    return {{"version", kFirmwareVersion},   {"run", panel_.run_},
            {"simulated", simulated()},      {"speed", panel_.speed_},
            {"usualFaults", usual_faults()}, {"lines", std::move(lines)},
            {"modules", std::move(modules)}};
  }

  void add(Message& message, const std::string& key, const Tracked& part) const {
    if (part.changed > sent_look_) {
      message[key] = part.value;
    }
  }

  [[nodiscard]] Message news_of(const Module& module) const {
    Message message;
    for (const auto& [key, part] : module.face) {
      add(message, key, part);
    }
    return message;
  }

  [[nodiscard]] Message news_of(const Watched& watched) const {
    Message message;
    message["now"] = microseconds(watched.now);
    add(message, "faults", watched.faults);
    return message;
  }

  Message frames_of(std::size_t line) {
    const Watched& watched = panel_.lines_[line];
    const std::uint64_t first = watched.recent.first_of(next_entries_[line], most_frames());
    Message entries = Message::array();
    for (std::uint64_t number = first; number < watched.recent.end(); ++number) {
      entries.push_back(message_of(watched.recent.entry(number), number, watched.modules.size()));
    }
    next_entries_[line] = watched.recent.end();
    return {{"line", line}, {"entries", std::move(entries)}};
  }

  Panel& panel_;
  std::uint64_t sent_look_ = 0;
  std::vector<std::uint64_t> next_entries_;  ///< for each line, the number of the next entry to send
  std::optional<Message> reply_;
  Message answers_ = Message::array();  ///< answers to console requests, for the next message
  std::size_t asked_ = 0;               ///< number of console requests without an answer
  std::shared_ptr<Viewer*> lives_ = std::make_shared<Viewer*>(this);
  std::set<std::string> held_;  ///< commands that undo the actions that the page holds active
  std::chrono::steady_clock::time_point last_sent_at_;
};

Panel::Panel(CarryOut carry_out, Ask ask, double speed, WallClock wall_clock)
    : carry_out_(std::move(carry_out)),
      ask_(std::move(ask)),
      speed_(speed),
      wall_clock_(std::move(wall_clock)),
      run_(random_id()) {}

Panel::~Panel() = default;

void Panel::add_line(PanelLine line) {
  Watched watched;
  for (const Watched& before : lines_) {
    watched.first_module += before.modules.size();
  }
  watched.modules.resize(line.models.size());
  watched.line = std::move(line);
  lines_.push_back(std::move(watched));
}

void Panel::hear(std::size_t line, const Frame& frame) { lines_[line].recent.add({frame, {}}); }

void Panel::note(std::size_t line, VirtualTime now, const std::string& text) {
  Frame frame;
  frame.began = frame.ended = now;
  lines_[line].recent.add({frame, text});
}

void Panel::look() {
  ++looks_;
  for (Watched& watched : lines_) {
    watched.capture(looks_);
  }
}

std::unique_ptr<PanelViewer> Panel::viewer() { return std::make_unique<Viewer>(*this); }

}  // namespace ex9000::sim
