// Real modules on a panel.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "sim/front_ends/panel/panel.hpp"
#include "sim/utility/real_line/watched_connection.hpp"
#include "sim/utility/scan/scan.hpp"

namespace ex9000::utility {

/// Polls the modules of a line, and sends the requests of the panel's pages in between.
class RealLine {
 public:
  /// `patience`: for replies to polls. Throws what MasterLine throws.
  RealLine(const Environment& environment, const Port& port, hal::SerialMode mode, Time patience);

  MasterLine& line() { return line_; }
  /// Once. Reads the settings of the modules. `found`: their models are known.
  void show_on(sim::Panel& panel, const std::vector<FoundModule>& found);
  /// For the panel.
  void ask(sim::RequestQueue::Request request) { asked_.push_back(std::move(request)); }
  /// Reads what may have changed in each module that replies, and one of its settings; asks one that does
  /// not. Throws what Connection throws.
  void look();

 private:
  struct Module {
    Device device;
    const Model* model;
    std::uint8_t address;
    std::optional<std::uint32_t> serial_number;
    bool replies = true;
    bool known = false;            ///< all settings have been read since something may have changed them
    std::size_t next_setting = 0;  ///< position in `properties`
    std::map<std::string, std::string> settings = {};
    sim::Message face = {};
  };

  [[nodiscard]] static Environment watched(Environment environment, WatchedConnection::See see);
  void see(const PortFrame& seen);
  void answer_page();
  void note_effect(const Data& request, const Data& reply);
  sim::RequestQueue::Reply answer_to(const sim::RequestQueue::Request& request);
  [[nodiscard]] std::size_t station_asked_by(const Data& request) const;
  void look_at(Module& module);
  void read_state(Module& module);
  void read_setting(Module& module, std::size_t position);
  void read_settings(Module& module);
  [[nodiscard]] sim::Message nameplate_of(const Module& module) const;

  sim::Panel* panel_ = nullptr;
  Environment environment_;
  MasterLine line_;
  Time patience_;
  Time began_;
  std::vector<Module> modules_;
  std::size_t speaker_ = 0;  ///< who is being asked, from 1
  std::size_t replies_ = 0;  ///< who has been asked by the last frame
  std::size_t turn_ = 0;     ///< who is asked in this look, of those that have not replied before
  std::deque<sim::RequestQueue::Request> asked_;
};

}  // namespace ex9000::utility
