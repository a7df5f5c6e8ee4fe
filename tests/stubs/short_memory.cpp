// Simulates a machine that is short of memory: loaded before the C++ library (LD_PRELOAD), it refuses objects of
// SHVR_SHORT_BYTES or more to the program itself while the file SHVR_SHORT_WHILE exists. A driver's libraries, which
// abort without memory, still get it. Each refusal is a line in the file SHVR_SHORT_LOG.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>

#include <fcntl.h>
#include <link.h>
#include <unistd.h>

namespace {

/// Whether code of the program asks, and not of a library.
bool is_of_program(const void* caller)
{
    const auto looks = [](dl_phdr_info* object, size_t /*size*/, void* found) {
        auto& address = *static_cast<uintptr_t*>(found);
        for (int i = 0; i < object->dlpi_phnum; ++i) {
            const ElfW(Phdr)& part = object->dlpi_phdr[i];
            const uintptr_t begin = object->dlpi_addr + part.p_vaddr;
            if (part.p_type == PT_LOAD && address >= begin && address < begin + part.p_memsz) address = 0;
        }
        return 1;  // the program is the first object
    };
    auto address = reinterpret_cast<uintptr_t>(caller);
    dl_iterate_phdr(looks, &address);
    return address == 0;
}

bool is_short_of(size_t bytes, const void* caller)
{
    static const char *const least = std::getenv("SHVR_SHORT_BYTES"),
                             *const meanwhile = std::getenv("SHVR_SHORT_WHILE"),
                             *const log = std::getenv("SHVR_SHORT_LOG");
    if (!least || !meanwhile || bytes < std::strtoull(least, nullptr, 10) || access(meanwhile, F_OK) != 0 ||
        !is_of_program(caller))
        return false;
    const int file = log ? open(log, O_WRONLY | O_CREAT | O_APPEND, 0600) : -1;
    if (file < 0) return true;
    char line[64];
    const int length = std::snprintf(line, sizeof line, "%zu\n", bytes);
    static_cast<void>(!write(file, line, size_t(length)));
    close(file);
    return true;
}

void* made(size_t bytes, size_t alignment, const void* caller)
{
    void* const memory = is_short_of(bytes, caller) ? nullptr
                         : alignment == 0           ? std::malloc(bytes == 0 ? 1 : bytes)
                                          : std::aligned_alloc(alignment, (bytes + alignment) / alignment * alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

void* operator new(size_t bytes)
{
    return made(bytes, 0, __builtin_return_address(0));
}

void* operator new[](size_t bytes)
{
    return made(bytes, 0, __builtin_return_address(0));
}

void* operator new(size_t bytes, std::align_val_t alignment)
{
    return made(bytes, size_t(alignment), __builtin_return_address(0));
}

void* operator new[](size_t bytes, std::align_val_t alignment)
{
    return made(bytes, size_t(alignment), __builtin_return_address(0));
}
