// The line on a port, with a master for each protocol.
#pragma once

#include <memory>
#include <string>

#include "sim/utility/console/environment.hpp"
#include "sim/utility/dcon/dcon_master.hpp"
#include "sim/utility/modbus/master.hpp"

namespace ex9000::utility {

class MasterLine {
 public:
  MasterLine(Environment& environment, const Port& port, hal::SerialMode mode);

  void set_mode(hal::SerialMode mode);
  [[nodiscard]] hal::SerialMode mode() const { return mode_; }
  /// A port on the network has its own mode: only one can be tried.
  [[nodiscard]] bool has_modes() const { return port_.kind == Port::Kind::Serial; }
  /// false: a gateway carries neither DCON nor requests by serial number.
  [[nodiscard]] bool carries_all() const { return port_.kind != Port::Kind::ModbusTcp; }

  /// As the user has written it.
  [[nodiscard]] const std::string& name() const { return port_.name; }

  Connection& connection() { return *connection_; }
  Master& modbus() { return *modbus_; }
  /// Only if the line carries all.
  DconMaster& dcon() { return *dcon_; }

 private:
  Port port_;
  hal::SerialMode mode_;
  std::unique_ptr<Connection> connection_;
  std::unique_ptr<Master> modbus_;
  std::unique_ptr<DconMaster> dcon_;
};

}  // namespace ex9000::utility
