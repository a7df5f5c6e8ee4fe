#pragma once
// Passes the latest value from one thread to another without a lock, in three slots: the writer owns one, the reader
// owns one, and they exchange the third. Neither side ever waits or allocates; values that the reader did not take in
// time are lost, by design. This is a triple buffer; see also farbot's RealtimeObject.
//
//     Latest<Pose> latest;
//     latest.writing() = pose; latest.publish();      // writer: any number of fields, then publish
//     if (latest.take()) use(latest.value());         // reader: value() stays as it is until the next take()
//
// One writing and one reading thread. Copying T must not throw. writing() returns a slot that still holds T{} or an
// older value, so a writer must set every field.

#include <array>
#include <atomic>
#include <cstdint>

namespace shvr {

template <class T>
class Latest {
public:
    T& writing() noexcept { return slots_[writer_]; }
    void publish() noexcept { writer_ = shared_.exchange(writer_ | FRESH, std::memory_order_acq_rel) & SLOT; }
    void publish(const T& value) noexcept
    {
        writing() = value;
        publish();
    }

    /// True if something was published since the last call; value() is then the latest.
    bool take() noexcept
    {
        if (!(shared_.load(std::memory_order_relaxed) & FRESH)) return false;
        reader_ = shared_.exchange(reader_, std::memory_order_acq_rel) & SLOT;
        return true;
    }
    const T& value() const noexcept { return slots_[reader_]; }

private:
    static constexpr uint32_t SLOT = 3;   ///< bits of a slot's index
    static constexpr uint32_t FRESH = 4;  ///< set while the reader has not taken the shared slot
    static_assert(std::atomic<uint32_t>::is_always_lock_free);

    std::array<T, 3> slots_{};
    // On separate cache lines, to avoid false sharing between the threads.
    alignas(64) uint32_t writer_ = 0;
    alignas(64) std::atomic<uint32_t> shared_{1};
    alignas(64) uint32_t reader_ = 2;
};

}  // namespace shvr
