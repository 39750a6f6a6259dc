// Stores what arrives at a port under test.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sim/files_and_ports/ports/port.hpp"

namespace ex9000::sim {

struct StoredArrivals final : Arrivals {
  bool bytes(const Port& /*port*/, Bytes bytes, const Positions& /*damaged*/, Sender its_sender) override {
    sender = its_sender;
    text.insert(text.end(), bytes.begin(), bytes.end());
    return !pauses;
  }
  bool requests(std::size_t size, std::function<void()> process) override {
    requested += size;
    processes.push_back(std::move(process));
    return !pauses;
  }
  void left(Sender its_sender) override { gone.push_back(its_sender); }
  void connected() override { ++connections; }

  bool pauses = false;  ///< the port must wait for `resume`
  std::string text;
  Sender sender = nullptr;  ///< of the last bytes
  std::vector<Sender> gone;
  std::size_t requested = 0;
  std::vector<std::function<void()>> processes;
  unsigned connections = 0;
};

}  // namespace ex9000::sim
