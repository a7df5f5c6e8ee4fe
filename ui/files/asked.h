#pragma once
// A query to the file system, answered in the background. A network that does not respond may take minutes to fail, so
// the main thread never waits for an answer, not even at exit: a destroyed query drops its answer.

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace shvr::ui {

/// Maximum wait of callers that want a fast answer in the same frame of the window.
inline constexpr std::chrono::milliseconds AT_ONCE{20};

template <class Answer>
class Asked {
public:
    Asked() = default;
    /// Calls `ask` on a thread of its own. `ask` must own all objects that it uses, since it may outlive the caller.
    template <class Ask>
    explicit Asked(Ask ask) : state_(std::make_shared<State>())
    {
        std::thread([state = state_, ask = std::move(ask)] {
            Answer answer{};
            try {
                answer = ask();
            } catch (const std::exception&) {  // out of memory: the answer is a default-constructed one
            }
            const std::scoped_lock lock(state->mutex);
            state->answer = std::move(answer);
            state->answered.notify_all();
        }).detach();
    }

    bool is_pending() const { return state_ != nullptr; }
    /// Returns the answer if it arrives within `patience`; each answer is returned once.
    std::optional<Answer> take(std::chrono::milliseconds patience = {})
    {
        if (!state_) return std::nullopt;
        std::unique_lock lock(state_->mutex);
        state_->answered.wait_for(lock, patience, [&] { return state_->answer.has_value(); });
        std::optional<Answer> answer = std::exchange(state_->answer, std::nullopt);
        lock.unlock();
        if (answer) state_.reset();
        return answer;
    }

private:
    struct State {
        std::mutex mutex;
        std::condition_variable answered;
        std::optional<Answer> answer;
    };
    std::shared_ptr<State> state_;
};

}  // namespace shvr::ui
