// The update of one module, step by step.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "firmware/update/update.hpp"
#include "sim/utility/modbus/module.hpp"
#include "sim/utility/update/update_file.hpp"

namespace ex9000::utility {

/// Call the steps in their order. Each throws Failed, or what Connection throws.
class ModuleUpdate {
 public:
  /// Gets how many bytes of the image the module has, and the length of the image.
  using Show = std::function<void(std::uint32_t has, std::uint32_t length)>;

  /// `file` must live as long.
  ModuleUpdate(Module module, const UpdateFile& file);

  [[nodiscard]] const std::string& name() const { return module_.name(); }

  /// Fails if the module cannot get this update. Changes nothing.
  void prepare();
  /// What the module does not have yet.
  void send(const Show& show);
  /// If the request is lost, `wait_until_it_runs` repeats it.
  void activate();
  void wait_until_it_runs();
  void wait_until_confirmed();

 private:
  struct Progress {
    update::State state;
    std::uint32_t next;  ///< offset
  };

  void begin();
  bool send_blocks(const Show& show);
  Answer read(unsigned address, unsigned count);
  Progress progress();
  update::State state_after(update::State passing, unsigned polls, Time pause);
  void check_version(update::State state, bool may_be_unconfirmed);

  Module module_;
  const UpdateFile& file_;
  update::Info info_;
};

}  // namespace ex9000::utility
