#include "firmware/settings/settings_keeper.hpp"

namespace ex9000 {

namespace {

constexpr Duration kRetry = milliseconds(1000);  // wire.md D15

}  // namespace

void SettingsKeeper::save(const Settings& settings, Time now) {
  end_own_save(now);
  store_.begin_saving(settings);
  may_differ_ = true;  // even if the save succeeds, because the host watchdog may expire during it
}

void SettingsKeeper::poll(const Settings& in_force, Time now) {
  if (busy()) {
    return;
  }
  end_own_save(now);
  const bool unsaved = may_differ_ && in_force != stored();
  if (!unsaved && !store_.needs_invalidation()) {
    may_differ_ = false;
    retry_.disarm();
    return;
  }
  if (retry_.armed() && !retry_.reached(now)) {
    return;
  }
  retry_.disarm();
  own_save_ = true;
  if (unsaved) {
    store_.begin_saving(in_force);
  } else {
    store_.begin_invalidating();
  }
}

void SettingsKeeper::end_own_save(Time now) {
  if (own_save_ && (!saved() || store_.needs_invalidation())) {
    retry_.set(now + kRetry);
  }
  own_save_ = false;
}

}  // namespace ex9000
