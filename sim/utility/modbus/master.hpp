// A Modbus master: RTU frames on a connection, or Modbus TCP.
#pragma once

#include <memory>

#include "sim/utility/connection/port.hpp"
#include "sim/utility/modbus/addressee.hpp"
#include "sim/utility/modbus/request.hpp"

namespace ex9000::utility {

class Master {
 public:
  Master() = default;
  Master(const Master&) = delete;
  Master& operator=(const Master&) = delete;
  virtual ~Master() = default;

  /// The PDU of the reply or of the exception; empty: none, also if a gateway says so. `patience`: from the
  /// end of the request to the beginning of the reply. Throws what Connection throws.
  virtual Data exchange(const Addressee& to, const Request& request, Time patience) = 0;
  virtual Connection& connection() = 0;
  /// Of the line, from now on.
  virtual void set_mode(hal::SerialMode /*mode*/) {}
  /// The adapter receives what it sends, as the last request has shown whose echo does not look like its
  /// reply, which that of functions 05 and 06 does.
  [[nodiscard]] bool echoes() const { return echoes_; }
  /// In the last exchange, if it had no reply.
  [[nodiscard]] Heard heard() const { return heard_; }

 protected:
  Heard heard_ = Heard::Nothing;
  bool echoes_ = false;
};

/// Makes a request or a reply a frame.
void append_crc(Data& frame);

/// RTU frames. `mode`: of the line, also if the connection is one to a gateway.
std::unique_ptr<Master> rtu_master(Connection& connection, hal::SerialMode mode);
/// A gateway does not carry requests by serial number.
std::unique_ptr<Master> tcp_master(Connection& connection);

}  // namespace ex9000::utility
