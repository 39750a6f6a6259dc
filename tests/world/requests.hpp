// Random requests, made from those of the transcripts.
#pragma once

#include <list>
#include <map>
#include <string>
#include <vector>

#include "tests/oracles/reference/module.hpp"
#include "tests/oracles/reference/random.hpp"

namespace ex9000::world {

using reference::Bytes;

class Requests {
 public:
  /// Loads all transcripts.
  Requests();

  using Sequence = std::vector<Bytes>;
  /// A request of a transcript.
  struct Place {
    const Sequence* requests = nullptr;
    std::size_t next = 0;
    bool modbus = false;
  };

  /// A request for the module, or a similar one, with its check. Some are for other modules, wrong or
  /// damaged. `place`: from the request before; the result is often the next one of its transcript.
  Bytes next(const reference::Module& module, reference::Random& random, Place& place) const;
  /// A request that sets the filter time of an input.
  static Bytes set_filter(const reference::Module& module, unsigned channel, reference::Random& random);
  /// An image for updates.
  struct Image {
    Bytes begin;    ///< the 32 bytes that announce it
    Bytes content;  ///< in whole blocks
  };
  /// `is_long`: about as long as a sector.
  static Image new_image(const reference::Module& module, reference::Random& random, bool is_long);
  /// The next request of an update, or another one that fits its state. `image`: the module's last one.
  static Bytes of_update(const reference::Module& module, reference::Random& random, Image& image,
                         bool may_be_long);
  static Bytes state_of_update(const reference::Module& module);
  /// The same request as a broadcast, or by serial number.
  static Bytes broadcast(Bytes request);
  static Bytes by_number(const reference::Module& module, Bytes request);
  static Bytes block(const reference::Module& module, const Image& image, std::size_t offset);
  /// A request that concerns the host watchdog.
  static Bytes of_watchdog(const reference::Module& module, reference::Random& random);

 private:
  using Forms = std::map<std::string, std::vector<Place>>;
  /// The requests that transcripts send to a model, without their checks.
  struct Pool {
    Forms ascii;
    Forms modbus;
  };

  void add(Forms& forms, const Sequence& requests, bool modbus);

  std::list<Sequence> sequences_;
  std::map<std::string, Pool> pools_;  ///< by designation
  Pool all_;
};

}  // namespace ex9000::world
