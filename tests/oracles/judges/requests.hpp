// The requests that a module has received and that it may still execute or reply to.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "tests/oracles/judges/demand.hpp"
#include "tests/oracles/judges/finding.hpp"
#include "tests/oracles/judges/time.hpp"

namespace ex9000::judges {

struct Request {
  std::array<std::uint8_t, 256> bytes;
  std::size_t size;
  Microseconds last;
  /// The earliest time at which the module judges the frame. In Modbus, this is the end of the silence after
  /// the frame, or the end of a reply of the module, if that end is earlier. In ASCII, it is the end of the
  /// turn-around time.
  Microseconds over;
  Demand demand;
  bool broadcast;
  bool alone;  ///< the module was idle when the frame began, and the frame is not doubtful
  bool fresh;  ///< the module may still execute it; see Witness::mark_fresh
  bool done;   ///< an observed change of values has been attributed to this request

  [[nodiscard]] Bytes frame() const { return {bytes.data(), size}; }
  /// Returns whether the request may store something and gets no reply. The module may then be busy until the
  /// time that Witness::latest_of returns.
  [[nodiscard]] bool is_silent_store() const { return broadcast && demand.stores_something; }
};

/// A queue of requests. The module keeps at least one frame while it executes another one, and may lose
/// further frames. A judge cannot observe such a loss, so the queue keeps more requests than the module
/// keeps.
class Requests {
 public:
  /// The greatest number of requests in the queue.
  static constexpr std::size_t kMost = 32;

  [[nodiscard]] std::size_t size() const { return size_; }
  /// Returns the request at `index`. Index 0 is the oldest request.
  Request& operator[](std::size_t index) { return requests_[(oldest_ + index) % kMost]; }
  const Request& operator[](std::size_t index) const { return requests_[(oldest_ + index) % kMost]; }

  void clear() { size_ = 0; }
  void drop_oldest(std::size_t count) {
    oldest_ = (oldest_ + count) % kMost;
    size_ -= count;
  }
  /// Appends a request with the frame of this finding, and returns the request. The queue must not be full.
  /// The caller must set `over`, `demand`, `alone` and `fresh`.
  Request& append(const Finding& finding) {
    Request& latest = (*this)[size_++];
    std::copy(finding.frame.begin(), finding.frame.end(), latest.bytes.begin());
    latest.size = finding.frame.size;
    latest.last = finding.last;
    latest.broadcast = finding.kind == Finding::Kind::Broadcast;
    latest.done = false;
    return latest;
  }

 private:
  std::array<Request, kMost> requests_;
  std::size_t oldest_ = 0;
  std::size_t size_ = 0;
};

}  // namespace ex9000::judges
