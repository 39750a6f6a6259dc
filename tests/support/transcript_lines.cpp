#include "tests/support/transcript_lines.hpp"

#include "sim/module_spec.hpp"

namespace ex9000::system {

namespace {

std::string pty(std::size_t position) { return std::to_string(position) + ".tty"; }

std::string line_of(const play::Transcript& transcript, std::size_t position) {
  std::string line = R"({"pty": ")" + pty(position) + R"(", "modules": [{"model": ")";
  line += std::string(transcript.model->designation) + "\"";
  if (transcript.preset_given) {
    const Settings& preset = transcript.preset;
    line += R"(, "address": ")" + sim::hex_byte_text(preset.address) + "\"";
    line += std::string(R"(, "protocol": )") +
            (preset.protocol == Protocol::Ascii ? R"("ascii")" : R"("modbus")");
    line += R"(, "baud": )" + std::to_string(baud_rate(preset.baud_code));
    line += std::string(R"(, "checksum": )") + ((preset.format & kFormatChecksum) != 0 ? "true" : "false");
    line += std::string(R"(, "edge": )") +
            ((preset.format & kFormatRisingEdge) != 0 ? R"("rising")" : R"("falling")");
  }
  return line + "}]}";
}

std::string bus_file(const Directory& directory, const std::vector<const play::Transcript*>& transcripts) {
  std::string lines;
  for (std::size_t position = 0; position < transcripts.size(); ++position) {
    lines += (position == 0 ? "" : ",\n") + line_of(*transcripts[position], position);
  }
  const std::string path = directory / "bus.json";
  write_file(path, R"({"control": "control", "lines": [)" + lines + "]}");
  return path;
}

}  // namespace

TranscriptLines::TranscriptLines(const std::vector<const play::Transcript*>& transcripts)
    : simulator_({bus_file(directory_, transcripts)}) {}

ProcessTarget TranscriptLines::target(std::size_t position) const {
  const std::string& directory = simulator_.directory();
  return {directory + "/" + pty(position), directory + "/control", position + 1};
}

}  // namespace ex9000::system
