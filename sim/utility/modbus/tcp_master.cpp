#include <algorithm>

#include "sim/front_ends/modbus_tcp/mbap.hpp"
#include "sim/text/fail.hpp"
#include "sim/utility/modbus/master.hpp"

namespace ex9000::utility {

namespace {

class TcpMaster final : public Master {
 public:
  explicit TcpMaster(Connection& connection) : connection_(connection) {}

  Data exchange(const Addressee& to, const Request& request, Time patience) override {
    if (!to.by_address()) {
      sim::fail(to.name +
                ": Modbus TCP carries no request by serial number; name an address, or another port");
    }
    ++transaction_;
    connection_.send(sim::mbap_bytes({transaction_, to.request[0], request.pdu}));
    const Time end = connection_.now() + patience + kOnTheLine;
    for (Data more; !(more = connection_.receive(end - connection_.now())).empty();) {
      reader_.add({more.data(), more.size()});
      while (const auto frame = reader_.next()) {
        if (frame->transaction == transaction_ && answers(frame->pdu, request)) {
          return is_no_reply(frame->pdu) ? Data() : frame->pdu;
        }
      }
      if (reader_.broken()) {
        sim::unavailable("the other side does not speak Modbus TCP; name a port that does, or tcp:HOST:PORT");
      }
    }
    return {};
  }

  Connection& connection() override { return connection_; }

 private:
  /// For the frames on the line behind the gateway, at any rate.
  static constexpr std::chrono::seconds kOnTheLine{2};

  /// What a gateway says if the module gives no reply.
  static bool is_no_reply(const Data& pdu) {
    constexpr std::uint8_t kTargetFailedToRespond = 0x0B;
    return pdu.size() == 2 && (pdu[0] & kExceptionBit) != 0 && pdu[1] == kTargetFailedToRespond;
  }
  static bool answers(const Data& pdu, const Request& request) {
    if (pdu[0] == (request.pdu[0] | kExceptionBit)) {
      return pdu.size() == 2;
    }
    return (request.reply_size == 0 || pdu.size() == request.reply_size) &&
           std::equal(request.reply.begin(), request.reply.end(), pdu.begin());
  }

  Connection& connection_;
  std::uint16_t transaction_ = 0;
  sim::MbapReader reader_;
};

}  // namespace

std::unique_ptr<Master> tcp_master(Connection& connection) { return std::make_unique<TcpMaster>(connection); }

}  // namespace ex9000::utility
