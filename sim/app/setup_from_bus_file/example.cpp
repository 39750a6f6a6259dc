#include "sim/app/setup_from_bus_file/bus_file.hpp"

namespace ex9000::sim {

std::string example_bus_file() {
  return R"({
  "control": "ex9000.ctl",
  "panel": true,
  "seed": 1,
  "lines": [
    {
      "name": "hall",
      "pty": "hall.tty",
      "baud": 9600,
      "modules": [
        {"model": "EX9042D-M", "address": "01", "eeprom": "hall-01.bin",
         "faults": ["lost-reply every 10th reply", "power-cut after 3 writes"]},
        {"model": "EX9052D-M", "address": "02", "edge": "rising",
         "inputs": ["0 square 100ms", "3 key every 10s for 300ms bounce 5ms"]}
      ],
      "faults": ["bit-errors 1e-5", "foreign-traffic 0501000000083C48 every 30s"]
    },
    {
      "name": "yard",
      "tcp": "127.0.0.1:5020",
      "line": "instant",
      "modules": [
        {"model": "EX9068D-M", "address": "0A", "protocol": "ascii", "checksum": true, "name": "PUMPS",
         "faults": ["late-reply 50ms with probability 0.01", "gone at 1h for 2min"]},
        {"model": "EX9055D", "address": "0B", "init": false}
      ]
    }
  ]
}
)";
}

}  // namespace ex9000::sim
