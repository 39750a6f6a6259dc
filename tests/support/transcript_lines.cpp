#include "tests/support/transcript_lines.hpp"

#include <memory>
#include <utility>

#include "sim/text/values.hpp"

namespace ex9000::system {

namespace {

std::string name(std::size_t position) { return "line-" + std::to_string(position); }

std::string line_of(const play::Transcript& transcript, std::size_t position, TranscriptLines::Over over) {
  std::string line = R"({"name": ")" + name(position) + R"(", )";
  line += over == TranscriptLines::Over::Tcp ? R"("port": "tcp:127.0.0.1:0")"
                                             : R"("port": "pty:)" + name(position) + "\"";
  line += R"(, "modules": [{"model": ")";
  line += std::string(transcript.model->designation) + "\"";
  if (transcript.preset_given) {
    const Settings& preset = transcript.preset;
    line += R"(, "address": ")" + sim::hex_byte_text(preset.address) + "\"";
    line += std::string(R"(, "protocol": )") +
            (preset.protocol == Protocol::Ascii ? R"("ascii")" : R"("modbus")");
    line += R"(, "baud": )" + std::to_string(baud_rate(preset.baud_code));
    line += R"(, "format": ")" + sim::line_format_text(line_format(preset.baud_code)) + "\"";
    line += std::string(R"(, "checksum": )") + ((preset.format & kFormatChecksum) != 0 ? "true" : "false");
    line += std::string(R"(, "edge": )") +
            ((preset.format & kFormatRisingEdge) != 0 ? R"("rising")" : R"("falling")");
    const auto module_name = preset.name.bytes();
    line += R"(, "name": ")" + std::string(module_name.begin(), module_name.end()) + "\"";
  }
  return line + "}]}";
}

std::string bus_file(const Directory& directory, const std::vector<const play::Transcript*>& transcripts,
                     TranscriptLines::Over over) {
  std::string lines;
  for (std::size_t position = 0; position < transcripts.size(); ++position) {
    lines += (position == 0 ? "" : ",\n") + line_of(*transcripts[position], position, over);
  }
  const std::string path = directory / "bus.json";
  write_file(path, R"({"control": "control", "lines": [)" + lines + "]}");
  return path;
}

}  // namespace

TranscriptLines::TranscriptLines(const std::vector<const play::Transcript*>& transcripts, Over over)
    : over_(over),
      simulator_({bus_file(directory_, transcripts, over), "--speed", "step"},
                 over == Over::Tcp ? shipped_simulator_path() : simulator_path()),
      control_(simulator_.directory() + "/control") {
  for (std::size_t module = 1; module <= transcripts.size(); ++module) {
    control_.ok(std::to_string(module) + " power off");
  }
}

ProcessTarget TranscriptLines::target(std::size_t position) {
  std::unique_ptr<MasterPort> port;
  if (over_ == Over::Tcp) {
    port = std::make_unique<TcpPort>(simulator_.tcp_port(position));
  } else {
    port = std::make_unique<TerminalPort>(simulator_.directory() + "/" + name(position));
  }
  return {std::move(port), control_, name(position), position + 1};
}

}  // namespace ex9000::system
