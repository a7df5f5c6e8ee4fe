#pragma once
// The base class of all services: references to the members of the desk, and the service's step of the main loop.
//
// A service has its own state, carries out the actions whose rows name it (`act`), and contributes its part of the
// model. Its header includes no other service: functions of other services that it calls are members of its struct
// `Others` (connected in services.h), so that a test can construct the service alone. No such function is called before
// all services are constructed.

#include <functional>
#include <string>
#include <utility>

#include "engine/workbench/desk/desk.h"

namespace shvr::ui {

/// A function that must be set when its owner is constructed: a member of this type that is not set does not compile.
template <class Signature>
class Call : public std::function<Signature> {
public:
    template <class Function>
    Call(Function called) : std::function<Signature>(std::move(called))
    {}
};

class Service {
public:
    Service(const Service&) = delete;
    /// Runs the service's step of the main loop (Workbench::advance).
    virtual void advance() {}
    /// Returns whether `advance` is also called while no document is open.
    virtual bool advances_without_document() const { return false; }

protected:
    explicit Service(Desk& desk);
    virtual ~Service() = default;

    /// State of a step of the main loop that is retried after a failure.
    struct Attempt {
        std::string said;       ///< message of the last failure
        double failed_s = 0.0;  ///< time of the last failure; 0: never
        double again_s = 0.0;
    };
    /// Runs `part`. A failure becomes a message, and later calls retry `part` after a pause. DeviceLost is rethrown.
    void attempt(Attempt& state, const std::function<void()>& part);
    void say(std::string text, Weight weight = Weight::done) { desk_.say(std::move(text), weight); }
    void log_instead(const Actions& actions) { desk_.log_instead(actions); }
    bool apply(const Action& action) { return desk_.apply(action); }
    Model model() const { return desk_.model(); }

    Desk& desk_;
    Renderer& renderer_;
    const WorkbenchOptions& options_;
    std::unique_ptr<Document>& document_;  ///< the desk's own pointer, by reference
    const std::function<void(const std::string&)>& log_;
    Jobs &jobs_, &savers_;

private:
    void note_failure(Attempt& state, const std::string& why);
};

}  // namespace shvr::ui
