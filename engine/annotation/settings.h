#pragma once
// Settings that are part of the user's work and can be undone, like paint: the transfer function, the colours of
// groups, the light. Each setting is the text of one section of the session, compared and stored byte for byte; only
// the session interprets the text (engine/session/lasting_settings.h).
//
// Not thread safe: the main thread owns them.

#include <map>
#include <string>

#include "engine/annotation/direction.h"

namespace shvr {

/// Texts by the names of their sections.
using SettingValues = std::map<std::string, std::string>;

/// The text of a section before and after a change. An empty text: not known yet.
struct SettingChange {
    std::string name;
    std::string before, after;
    bool operator==(const SettingChange&) const = default;
};

class Settings {
public:
    Settings() = default;
    explicit Settings(SettingValues values) : values_(std::move(values)) {}
    const SettingValues& values() const { return values_; }

    /// Returns why the change cannot be applied; empty if it can. Does not compare old values, since another version of
    /// the program may have spelled them differently.
    std::string why_it_does_not_fit(const SettingChange& change, Direction direction) const;
    void apply(const SettingChange& change, Direction direction);

private:
    SettingValues values_;
};

}  // namespace shvr
