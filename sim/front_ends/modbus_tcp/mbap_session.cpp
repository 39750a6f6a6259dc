#include "sim/front_ends/modbus_tcp/mbap_session.hpp"

namespace ex9000::sim {

void MbapSession::receive(Bytes bytes) {
  reader_.add(bytes);
  pass_on();
}

void MbapSession::pass_on() {
  if (passing_on_) {
    return;  // `ask_on_line` below has called `answer`; the loop continues
  }
  passing_on_ = true;
  while (!waiting_) {
    const std::optional<MbapFrame> request = reader_.next();
    if (!request) {
      break;
    }
    waiting_ = true;
    const std::weak_ptr<MbapSession*> lives = lives_;
    ask_on_line(
        line_, *request, lives,
        [lives, request = *request](const std::optional<std::vector<std::uint8_t>>& pdu) {
          if (const auto session = lives.lock()) {
            (*session)->answer(request, pdu);
          }
        },
        timeout_);
  }
  passing_on_ = false;
}

void MbapSession::answer(const MbapFrame& request, const std::optional<std::vector<std::uint8_t>>& pdu) {
  waiting_ = false;
  if (pdu) {
    const std::vector<std::uint8_t> bytes = mbap_bytes({request.transaction, request.unit, *pdu});
    replies.insert(replies.end(), bytes.begin(), bytes.end());
  }
  pass_on();
  answered_();
}

}  // namespace ex9000::sim
