#include "tests/unit/haptics/allocations.h"

#include <algorithm>
#include <cstdlib>
#include <new>

constinit thread_local bool counts_allocations = false;
constinit thread_local uint64_t allocations = 0;

namespace {

void* allocate(size_t bytes, size_t alignment)
{
    if (counts_allocations) ++allocations;
    // aligned_alloc requires multiples of the alignment.
    void* memory = alignment == 0 ? std::malloc(std::max<size_t>(bytes, 1))
                                  : std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(size_t bytes)
{
    return allocate(bytes, 0);
}
void* operator new(size_t bytes, std::align_val_t alignment)
{
    return allocate(bytes, size_t(alignment));
}
// Sanitizers replace this operator with one that bypasses the others.
void* operator new(size_t bytes, const std::nothrow_t&) noexcept
{
    if (counts_allocations) ++allocations;
    return std::malloc(std::max<size_t>(bytes, 1));
}
void operator delete(void* memory) noexcept
{
    std::free(memory);
}
void operator delete(void* memory, size_t) noexcept
{
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept
{
    std::free(memory);
}
void operator delete(void* memory, size_t, std::align_val_t) noexcept
{
    std::free(memory);
}
