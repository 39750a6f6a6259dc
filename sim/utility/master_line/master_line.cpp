#include "sim/utility/master_line/master_line.hpp"

namespace ex9000::utility {

MasterLine::MasterLine(Environment& environment, const Port& port, hal::SerialMode mode)
    : port_(port), connection_(environment.open(port, mode)) {
  set_mode(mode);
}

void MasterLine::set_mode(hal::SerialMode mode) {
  mode_ = mode;
  connection_->set_mode(mode);
  modbus_ = carries_all() ? rtu_master(*connection_, mode) : tcp_master(*connection_);
  const bool checksum = dcon_ != nullptr && dcon_->checksum();
  dcon_ = std::make_unique<DconMaster>(*connection_, mode);
  dcon_->set_checksum(checksum);
}

}  // namespace ex9000::utility
