#pragma once
// Messages that the program has shown to the user, with their weight. Main thread only.

#include <array>
#include <cstdint>
#include <ctime>
#include <deque>
#include <exception>
#include <string>

namespace shvr::ui {

/// Returns the message of an exception in the form that is shown to the user. Exhausted memory is reported with the
/// amount that the program has used, and with what helps.
std::string told_of(const std::exception& error);

enum class Weight {
    done,     ///< the result of an action
    warning,  ///< something is unexpected, but work continues
    error     ///< something was not done
};

struct Message {
    uint64_t number = 0;  ///< counted from 1
    double time_s = 0.0;  ///< time by the workbench's clock
    std::time_t at = 0;   ///< wall-clock time
    Weight weight = Weight::done;
    std::string text;
};

/// The last messages; older ones are forgotten.
class MessageLog {
public:
    static constexpr size_t MAX_MESSAGES = 1000;

    void add(double time_s, Weight weight, std::string text)
    {
        messages_.push_back({++count_, time_s, std::time(nullptr), weight, std::move(text)});
        ++unread_[size_t(weight)];
        if (messages_.size() > MAX_MESSAGES) messages_.pop_front();
    }
    /// Replaces the text of message `number`, for example to update progress. If that is not the last message, for
    /// example 0, adds one instead: nothing that was said in between is lost. Returns the number of the message.
    uint64_t amend(uint64_t number, double time_s, std::string text)
    {
        if (messages_.empty() || messages_.back().number != number) {
            add(time_s, Weight::done, std::move(text));
            return count_;
        }
        Message& last = messages_.back();
        last.time_s = time_s;
        last.at = std::time(nullptr);
        last.text = std::move(text);
        return number;
    }
    /// Returns all kept messages, oldest first.
    const std::deque<Message>& all() const { return messages_; }
    /// Returns the last message; empty before the first message.
    const std::string& last() const
    {
        static const std::string NOTHING;
        return messages_.empty() ? NOTHING : messages_.back().text;
    }
    uint64_t count() const { return count_; }
    /// Returns the first message of that weight with a number above `count`; null if there is none or if it was
    /// dropped.
    const Message* first_after(uint64_t count, Weight weight) const
    {
        for (const Message& message : messages_)
            if (message.number > count && message.weight == weight) return &message;
        return nullptr;
    }
    /// Returns how many messages of that weight came since `note_read`, including dropped ones.
    uint64_t unread(Weight weight) const { return unread_[size_t(weight)]; }
    void note_read() { unread_ = {}; }

private:
    std::deque<Message> messages_;
    uint64_t count_ = 0;
    std::array<uint64_t, 3> unread_{};
};

/// Shortens paths to their last component, for narrow places: "Saved .../leaf.json". A path starts at the start of a
/// word. It ends before " and ", before punctuation followed by a space, or at the end of the text.
std::string without_folders(const std::string& text);

}  // namespace shvr::ui
