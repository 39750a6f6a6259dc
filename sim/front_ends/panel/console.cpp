#include "sim/front_ends/panel/console.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <vector>

#include "sim/line_monitor/frames/frame_meaning.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/line/rtu_frame.hpp"

namespace ex9000::sim {

namespace {

constexpr std::size_t kLongestText = 1000;  // a PDU of 253 bytes with blanks has 758 characters
constexpr std::size_t kLongestPdu = 253;
constexpr std::string_view kDelimiters = "$#%@~";

bool is_dcon(const std::string& text) {
  return !text.empty() && kDelimiters.find(text[0]) != std::string_view::npos;
}

bool is_broadcast(const ConsoleRequest& request) {
  return is_dcon(request.text) ? request.text.compare(1, 2, "**") == 0 : request.address == kRtuBroadcast;
}

std::string exception_text(std::uint8_t code) {
  constexpr std::array<std::string_view, 5> kNames{"", "illegal function", "illegal data address",
                                                   "illegal data value", "server device failure"};
  return "exception " + hex_byte_text(code) +
         (code < kNames.size() && code != 0 ? ": " + std::string(kNames[code]) : "");
}

/// The lowest bit of each byte first.
std::string bits_text(Bytes bytes, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < std::min(count, bytes.size * 8); ++i) {
    text += text.empty() ? "" : " ";
    text += (bytes[i / 8] >> i % 8 & 1U) != 0 ? "1" : "0";
  }
  return text;
}

std::string words_text(Bytes bytes) {
  std::string text;
  for (std::size_t i = 0; i + 1 < bytes.size; i += 2) {
    const unsigned word = bytes.word(i);
    text += (text.empty() ? "" : ", ") + hex_word_text(word) + " (" + std::to_string(word) + ")";
  }
  return text;
}

/// Of PDUs: the exception, or the values of a function 01 to 04, else empty.
std::string values_text(Bytes request, Bytes reply) {
  constexpr std::size_t kValues = 2;  // after the function code and the byte count
  const std::uint8_t function = reply[0];
  if ((function & kRtuException) != 0) {
    return exception_text(reply[1]);
  }
  if (function < 0x01 || function > 0x04 || request.size < 5) {
    return "";
  }
  const std::string values =
      function <= 0x02 ? bits_text(reply.from(kValues), request.word(3)) : words_text(reply.from(kValues));
  return "from " + hex_word_text(request.word(1)) + ": " + values;
}

std::string decoded(const ConsoleRequest& request, Bytes sent, const std::vector<std::uint8_t>& reply) {
  if (!is_dcon(request.text)) {
    std::string values = values_text(pdu_of(sent), pdu_of({reply.data(), reply.size()}));
    if (!values.empty()) {
      return values;
    }
  }
  return meaning(reply, Speaker::Module);
}

}  // namespace

std::optional<ConsoleRequest> parse_console_request(const Message& message) {
  const auto is_unsigned = [&message](const char* key) {
    return message.contains(key) && message[key].is_number_unsigned();
  };
  if (message.size() != 4 || !is_unsigned("id") || !is_unsigned("line") || !is_unsigned("address") ||
      !message.contains("ask") || !message["ask"].is_string()) {
    return std::nullopt;
  }
  const auto address = message["address"].get<std::uint64_t>();
  if (address > kLastRtuAddress) {
    return std::nullopt;
  }
  return ConsoleRequest{message["id"], message["line"], static_cast<std::uint8_t>(address), message["ask"]};
}

RequestQueue::Request frame_of(const ConsoleRequest& request) {
  RequestQueue::Request frame;
  frame.expects_reply = !is_broadcast(request);
  if (request.text.size() > kLongestText) {
    fail(std::to_string(request.text.size()) + " characters: expected at most " +
         std::to_string(kLongestText));
  }
  if (is_dcon(request.text)) {
    frame.bytes.assign(request.text.begin(), request.text.end());
    frame.bytes.push_back('\r');
    return frame;
  }
  std::vector<std::uint8_t> pdu;
  try {
    pdu = parse_hex_bytes(request.text);
  } catch (const std::invalid_argument&) {
    fail("'" + request.text +
         "': expected a DCON command such as $01M, or a PDU in hex such as 01 0000 0008");
  }
  if (pdu.size() > kLongestPdu) {
    fail(std::to_string(pdu.size()) + " bytes: expected a PDU of at most " + std::to_string(kLongestPdu) +
         " bytes");
  }
  frame.bytes = rtu_frame(request.address, pdu);
  return frame;
}

Message answer_to(const ConsoleRequest& request, const RequestQueue::Reply& reply) {
  using std::chrono::duration_cast;
  const auto limit = duration_cast<std::chrono::milliseconds>(RequestQueue::kReplyTimeout).count();
  const std::string within = "within " + std::to_string(limit) + " ms";
  if (!reply.sent) {
    return rejection_of(request, "not sent: other masters did not stop sending " + within);
  }
  if (is_broadcast(request)) {
    return {{"id", request.id},
            {"ok", true},
            {"text", ""},
            {"meaning", "sent to all modules, which do not reply"}};
  }
  if (reply.bytes.empty()) {
    return rejection_of(request, "no reply " + within);
  }
  const std::vector<std::uint8_t> frame = frame_of(request).bytes;
  const Bytes sent{frame.data(), frame.size()};
  Message answer{{"id", request.id},
                 {"ok", true},
                 {"text", shown(reply.bytes)},
                 {"meaning", ""},
                 {"delay", duration_cast<std::chrono::microseconds>(reply.delay).count()}};
  if (reply.damaged) {
    answer["ok"] = false;
    answer["meaning"] = "damaged: a byte has a wrong stop bit or parity, or the frame is too long";
  } else if (!is_dcon(request.text) && !is_rtu_reply(sent, {reply.bytes.data(), reply.bytes.size()})) {
    answer["ok"] = false;
    answer["meaning"] = "not a reply to this request";
  } else {
    answer["meaning"] = decoded(request, sent, reply.bytes);
  }
  return answer;
}

Message rejection_of(const ConsoleRequest& request, const std::string& why) {
  return {{"id", request.id}, {"ok", false}, {"text", why}};
}

}  // namespace ex9000::sim
