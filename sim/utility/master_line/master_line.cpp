#include "sim/utility/master_line/master_line.hpp"

namespace ex9000::utility {

MasterLine::MasterLine(Environment& environment, const Port& port, hal::SerialMode mode)
    : port_(port),
      mode_(mode),
      connection_(environment.open(port, mode)),
      modbus_(carries_all() ? rtu_master(*connection_, mode) : tcp_master(*connection_)),
      dcon_(std::make_unique<DconMaster>(*connection_, mode)) {
  set_mode(mode);
}

void MasterLine::set_mode(hal::SerialMode mode) {
  mode_ = mode;
  connection_->set_mode(mode);
  modbus_->set_mode(mode);
  dcon_->set_mode(mode);
}

}  // namespace ex9000::utility
