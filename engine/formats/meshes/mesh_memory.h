#pragma once
// The memory that reading a mesh may take: each large block is taken here before it is allocated. One thread.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/error.h"

namespace shvr {

class MeshMemory {
public:
    /// `name`: the file, in messages.
    MeshMemory(std::string name, uint64_t limit) : name_(std::move(name)), limit_(limit) {}

    /// Fails if less than this is left.
    void take(uint64_t bytes)
    {
        if (bytes > limit_ - used_)
            fail(name_, ": takes at least ", mib_of(used_) + mib_of(bytes),
                 " MiB of memory to be read; expected at most ", limit_ >> 20,
                 " MiB, which it may take: decimate it, or allow more memory");
        used_ += bytes;
    }
    void release(uint64_t bytes) { used_ -= bytes; }

    /// Makes room in `values` for `capacity` of them. The old block and the new one exist together for a moment.
    template <class Value>
    void make_room(std::vector<Value>& values, uint64_t capacity)
    {
        if (capacity <= values.capacity()) return;
        const uint64_t old = values.capacity();
        take(capacity > UINT64_MAX / sizeof(Value) ? UINT64_MAX : capacity * sizeof(Value));
        values.reserve(capacity);
        release(old * sizeof(Value));
    }
    /// Appends a value; doubles the room where it is used up.
    template <class Value>
    void append(std::vector<Value>& values, const Value& value)
    {
        constexpr uint64_t FIRST = 64;
        if (values.size() == values.capacity()) make_room(values, values.empty() ? FIRST : 2 * values.size());
        values.push_back(value);
    }

private:
    static double mib_of(uint64_t bytes) { return double(bytes) / (1 << 20); }

    std::string name_;
    uint64_t limit_, used_ = 0;
};

}  // namespace shvr
