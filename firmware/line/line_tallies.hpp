// What the receive interrupt counts for Modbus function 08 (Modbus over Serial Line V1.02, appendix A).
#pragma once

#include "firmware/line/event_tally.hpp"

namespace ex9000 {

struct LineTallies {
  EventTally bus_messages;
  EventTally bus_errors;
  EventTally server_messages;
  EventTally no_responses;
  EventTally overruns;

  /// Main loop.
  void clear() {
    bus_messages.clear();
    bus_errors.clear();
    server_messages.clear();
    no_responses.clear();
    overruns.clear();
  }
};

}  // namespace ex9000
