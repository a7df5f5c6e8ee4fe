#include "engine/base/waits/unfinished_work.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "engine/base/text.h"

namespace shvr {

namespace {

/// A path of the greatest length, with words around it.
constexpr size_t SLOT_BYTES = 4096 + 512;

enum class State { free, being_written, listed };

/// A signal handler may read the words while another thread unlists them, so that they are never freed.
struct Slot {
    std::atomic<State> state = State::free;
    std::array<char, SLOT_BYTES> words{};  ///< ends with a null byte, also while it is written
};
std::array<Slot, 8> slots;
static_assert(std::atomic<State>::is_always_lock_free);

}  // namespace

UnfinishedWork::UnfinishedWork(const std::string& text)
{
    const std::string words = printable(text);  // paths may contain escape codes of terminals
    if (words.size() >= SLOT_BYTES) return;
    for (size_t number = 0; number < slots.size(); ++number) {
        Slot& slot = slots[number];
        State found = State::free;
        if (!slot.state.compare_exchange_strong(found, State::being_written)) continue;
        const auto end = std::ranges::copy(words, slot.words.begin()).out;
        std::fill(end, slot.words.end(), '\0');
        slot.state = State::listed;
        slot_ = int(number);
        return;
    }
}

UnfinishedWork::~UnfinishedWork()
{
    if (slot_ >= 0) slots[size_t(slot_)].state = State::free;
}

void name_unfinished_work(void (*say)(const char* text))
{
    for (const Slot& slot : slots)
        if (slot.state == State::listed) say(slot.words.data());
}

}  // namespace shvr
