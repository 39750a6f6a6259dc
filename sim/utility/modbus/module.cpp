#include "sim/utility/modbus/module.hpp"

#include "sim/text/values.hpp"

namespace ex9000::utility {

std::string Answer::text() const {
  std::string text;
  for (std::size_t i = 0; 2 * i < data.size() && word(i) != 0; ++i) {
    text += static_cast<char>(word(i));
  }
  return text;
}

std::string exception_text(std::uint8_t exception) {
  struct Row {
    std::uint8_t code;
    const char* name;
  };
  // Modbus Application Protocol V1.1b3, 7
  constexpr Row kRows[] = {{0x01, "illegal function"},   {0x02, "illegal data address"},
                           {0x03, "illegal data value"}, {0x04, "server device failure"},
                           {0x06, "server device busy"}, {0x0A, "gateway path unavailable"}};
  std::string text = "exception " + sim::hex_byte_text(exception);
  for (const Row& row : kRows) {
    if (row.code == exception) {
      text += std::string(" (") + row.name + ")";
    }
  }
  return text;
}

std::optional<Answer> Module::try_once(const Request& request, Time patience) {
  const Data pdu = master_->exchange(to_, request, patience);
  if (pdu.empty() || ((pdu[0] & kExceptionBit) != 0 && pdu[1] == 0)) {  // no exception has the code 0
    return std::nullopt;
  }
  if ((pdu[0] & kExceptionBit) != 0) {
    return Answer{{}, pdu[1]};
  }
  return Answer{{pdu.begin() + static_cast<std::ptrdiff_t>(request.reply.size()), pdu.end()}};
}

Answer Module::ask(const Request& request, Time patience) {
  constexpr unsigned kTries = 4;
  const Time began = master_->connection().now();
  for (unsigned i = 0; i < kTries; ++i) {
    if (auto answer = try_once(request, patience)) {
      if (i != 0) {
        master_->connection().drop_late_replies(began);
      }
      return *answer;
    }
  }
  throw Failed(master_->heard() == Heard::Noise
                   ? "gives no reply, but bytes that are none: several modules with this address, or noise"
                   : "gives no reply; check address, rate, format, protocol (Modbus) and wires");
}

}  // namespace ex9000::utility
