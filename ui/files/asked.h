#pragma once
// A question to the file system that is asked beside the main thread. A network that does not answer takes minutes, so
// nobody has to wait for it, at the end of the program either: what nobody wants to know any more is forgotten.

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace shvr::ui {

/// What a disk answers within this time is taken in the same frame of the window.
inline constexpr std::chrono::milliseconds AT_ONCE{20};

template <class Answer>
class Asked {
public:
    Asked() = default;
    /// `ask`, which must own all that it uses, is called on a thread of its own.
    template <class Ask>
    explicit Asked(Ask ask) : state_(std::make_shared<State>())
    {
        std::thread([state = state_, ask = std::move(ask)] {
            Answer answer{};
            try {
                answer = ask();
            } catch (const std::exception&) {  // no memory: as if there was nothing to say
            }
            const std::scoped_lock lock(state->mutex);
            state->answer = std::move(answer);
            state->answered.notify_all();
        }).detach();
    }

    bool is_pending() const { return state_ != nullptr; }
    /// The answer, once, if there is one by then.
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
