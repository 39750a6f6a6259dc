// A run of the program: the line, its modules' memories, its ports and its control socket.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/arguments.hpp"
#include "sim/bus_log.hpp"
#include "sim/control/control_socket.hpp"
#include "sim/eeprom_file.hpp"
#include "sim/greeting.hpp"
#include "sim/line.hpp"
#include "sim/pacer.hpp"

namespace ex9000::sim {

class Session {
 public:
  using Print = std::function<void(const std::string& line)>;

  /// Opens all that the arguments name. Throws std::invalid_argument or std::runtime_error, one line; what
  /// was opened is given back then, and no file has been made or changed. `print` and `io` live as long as
  /// this object.
  Session(boost::asio::io_context& io, Arguments arguments, Print print);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Makes the EEPROM files that are missing, prints the greeting, and puts the line to work as soon as `io`
  /// runs. Throws likewise.
  void start();

 private:
  /// Before the modules come up, so that they find it.
  void use_memories();
  void open_ports();
  void open_control();
  void renew_memories();
  void make_missing_memories();
  void keep_memories();
  [[nodiscard]] std::string remark(std::size_t index) const;
  void introduce();

  boost::asio::io_context& io_;
  const Arguments arguments_;
  Print print_;
  std::vector<std::unique_ptr<EepromFile>> memories_;  ///< one a module; null: none
  std::unique_ptr<Line> line_;
  LineIntroduced introduced_;
  Pacer::Ports ports_;
  std::optional<BusLog> log_;
  std::unique_ptr<Pacer> pacer_;
  std::optional<Control> control_;
  std::unique_ptr<ControlSocket> control_socket_;
};

}  // namespace ex9000::sim
