#pragma once
// Looks that the user saves for all scans, in a folder next to the file of preferences.

#include "engine/session/looks/named_look.h"
#include "engine/workbench/desk/service.h"

namespace shvr::ui {

class LookShelf : public Service {
public:
    /// Functions of other services that it calls.
    struct Others {
        Call<void(Session)> take_session;
        Call<void(const std::string& label)> record_settings;  ///< empty: the step is called by what differs
    };
    LookShelf(Desk& desk, Others others) : Service(desk), others_(std::move(others)) {}
    void act(const KeepLook& action);
    void act(const TakeLook& action);
    void act(const ForgetLook& action);

    /// Loads the user's looks.
    void load();
    LookModel model() const { return {.looks = looks_}; }

private:
    std::filesystem::path folder() const;

    const Others others_;
    std::vector<NamedLook> looks_;
};

}  // namespace shvr::ui
