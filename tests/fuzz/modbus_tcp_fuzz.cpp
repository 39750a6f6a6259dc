// Lets four clients of Modbus TCP send any bytes to one line, split and joined in any way. The target finds
// the requests in the bytes of each client without the simulator's code. Each request except a broadcast must
// get exactly one reply, unless its client leaves first. The simulator must send nothing else to the clients.
//
// The input is a sequence of events:
//
//     0-3  N, N bytes   the bytes arrive from this client, in one piece
//     4-7               client 0 to 3 leaves, and another one takes its place
//     8    N            N times 4 ms pass
//
// If the input has fewer than N bytes left, the piece contains the bytes that are left. Other values, and an
// event in the last byte of the input, have no effect.
#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <memory>
#include <vector>

#include "sim/front_ends/modbus_tcp/mbap_session.hpp"
#include "sim/notation/module_notation.hpp"
#include "tests/fuzz/require.hpp"

namespace ex9000::fuzz {
namespace {

using Buffer = std::vector<std::uint8_t>;
using std::chrono::milliseconds;

constexpr std::size_t kHeader = 7;
constexpr std::uint8_t kLastUnit = 247;

unsigned word(const Buffer& bytes, std::size_t at) { return bytes[at] * 256U + bytes[at + 1]; }

/// A client with the requests that have no reply yet.
class Client {
 public:
  explicit Client(sim::Line& line) : session_(line, [this] { take(); }) {}

  void send(const std::uint8_t* bytes, std::size_t size) {
    sent_.insert(sent_.end(), bytes, bytes + size);
    find_requests();
    session_.receive({bytes, size});
  }
  void check_end() const {
    require(asked_.empty(), "each request gets a reply");
    require(session_.idle(), "the session knows that all requests are answered");
    require(session_.broken() == broken_, "a wrong header breaks the stream");
  }

 private:
  struct Asked {
    unsigned transaction;
    std::uint8_t unit;
    std::uint8_t function;
  };

  /// Takes the complete frames from `sent_`. The header of a frame contains the transaction, protocol 0, a
  /// length of 2 to 254, and the unit. Any other protocol or length breaks the stream.
  void find_requests() {
    while (!broken_ && sent_.size() >= kHeader - 1) {
      const unsigned length = word(sent_, 4);
      if (word(sent_, 2) != 0 || length < 2 || length > 254) {
        broken_ = true;
      } else if (sent_.size() >= 6 + length) {
        if (sent_[6] != 0) {
          asked_.push_back({word(sent_, 0), sent_[6], sent_[7]});
        }
        sent_.erase(sent_.begin(), sent_.begin() + 6 + static_cast<std::ptrdiff_t>(length));
      } else {
        return;
      }
    }
  }

  void take() {
    Buffer& replies = session_.replies;
    while (!replies.empty()) {
      require(replies.size() > kHeader, "a reply has a header and a PDU");
      const std::size_t size = word(replies, 4) + kHeader - 1;
      require(word(replies, 2) == 0 && size > kHeader && size <= 260 && size <= replies.size(),
              "the header is correct");
      const auto end = replies.begin() + static_cast<std::ptrdiff_t>(size);
      const Buffer reply(replies.begin(), end);
      replies.erase(replies.begin(), end);
      require(!asked_.empty(), "a reply belongs to a request");
      const Asked asked = asked_.front();
      asked_.pop_front();
      require(asked.transaction == word(reply, 0) && asked.unit == reply[6],
              "replies keep the order of requests");
      check(asked, reply);
    }
  }

  static void check(const Asked& asked, const Buffer& reply) {
    require((reply[kHeader] | 0x80U) == (asked.function | 0x80U), "a reply has the function of its request");
    if (asked.unit > kLastUnit) {
      require(reply.size() == kHeader + 2 && reply[kHeader + 1] == 0x0A,
              "a unit above 247 gets exception 0A");
    } else if (asked.unit > 2) {
      require(reply.size() == kHeader + 2 && reply[kHeader + 1] == 0x0B,
              "a unit without a Modbus module gets exception 0B");
    }
  }

  Buffer sent_;
  bool broken_ = false;
  std::deque<Asked> asked_;
  sim::MbapSession session_;
};

class Clients {
 public:
  Clients() {
    line_.come_up();
    for (auto& client : clients_) {
      client = std::make_unique<Client>(line_);
    }
  }

  void live(const std::uint8_t* data, std::size_t size) {
    for (std::size_t at = 0; at + 1 < size;) {
      const std::uint8_t event = data[at++];
      if (event < 4) {
        const std::size_t piece = std::min<std::size_t>(data[at], size - at - 1);
        clients_[event]->send(data + at + 1, piece);
        at += 1 + piece;
      } else if (event < 8) {
        clients_[event - 4U] = std::make_unique<Client>(line_);
      } else if (event == 8) {
        line_.wires().run_for(milliseconds(4 * data[at++]));
      }
    }
    while (line_.requests().busy()) {
      line_.wires().run_for(milliseconds(50));
    }
    for (const auto& client : clients_) {
      client->check_end();
    }
  }

 private:
  sim::Line line_{{sim::parse_module_spec("EX9042D-M@01"), sim::parse_module_spec("EX9052D-M@02"),
                   sim::parse_module_spec("EX9042D@03")},
                  sim::kInstant,
                  [](std::uint8_t /*byte*/, ByteStatus /*status*/) {}};
  std::array<std::unique_ptr<Client>, 4> clients_;
};

}  // namespace
}  // namespace ex9000::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ex9000::fuzz::Clients().live(data, size);
  return 0;
}
