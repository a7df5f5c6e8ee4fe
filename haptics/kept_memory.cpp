#include "haptics/kept_memory.h"

#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>

namespace shvr {
namespace {

struct Pages {
    std::byte* begin;
    size_t bytes;
};
Pages pages_of(void* begin, size_t bytes)
{
    const auto page = uintptr_t(::sysconf(_SC_PAGESIZE));
    const uintptr_t first = reinterpret_cast<uintptr_t>(begin) / page * page;
    const uintptr_t end = (reinterpret_cast<uintptr_t>(begin) + bytes + page - 1) / page * page;
    return {reinterpret_cast<std::byte*>(first), end - first};
}

/// Applies the advice `how` (madvise) and locks the pages. Locking also loads them, unless the system refuses the lock.
bool keep(const Pages& pages, int how) noexcept
{
    static_cast<void>(::madvise(pages.begin, pages.bytes, how));
    return ::mlock(pages.begin, pages.bytes) == 0;
}

/// Returns true for the program and the libraries that ticks call, but not for drivers, which are many times larger.
bool is_used_by_ticks(const char* file)
{
    return file[0] == '\0' || std::strstr(file, "/libc.so") || std::strstr(file, "/libm.so");
}

int keep_code_of(dl_phdr_info* object, size_t, void* all_kept)
{
    if (!is_used_by_ticks(object->dlpi_name)) return 0;
    for (size_t i = 0; i < object->dlpi_phnum; ++i) {
        const auto& segment = object->dlpi_phdr[i];
        if (segment.p_type != PT_LOAD || !(segment.p_flags & PF_X)) continue;
        const Pages pages = pages_of(reinterpret_cast<void*>(object->dlpi_addr + segment.p_vaddr), segment.p_memsz);
        if (!keep(pages, MADV_POPULATE_READ)) *static_cast<bool*>(all_kept) = false;
    }
    return 0;
}

}  // namespace

KeptMemory::KeptMemory(void* begin, size_t bytes) noexcept
    : begin_(pages_of(begin, bytes).begin),
      bytes_(pages_of(begin, bytes).bytes),
      is_kept_(keep({begin_, bytes_}, MADV_POPULATE_WRITE))
{}

KeptMemory::~KeptMemory()
{
    if (is_kept_) ::munlock(begin_, bytes_);
}

bool keep_code() noexcept
{
    static const bool is_kept = [] {
        bool all = true;
        ::dl_iterate_phdr(keep_code_of, &all);
        return all;
    }();
    return is_kept;
}

}  // namespace shvr
