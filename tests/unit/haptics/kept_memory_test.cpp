// The servo's memory is there before its first tick, and stays: a first touch after hours finds its code in memory.

#include "haptics/kept_memory.h"

#include <link.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <memory>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "haptics/servo.h"
#include "tests/support/haptic_scenes.h"

using namespace shvr;

namespace {

constexpr uint64_t MILLISECOND = 1'000'000;

std::byte* page_of(const void* address)
{
    const auto page = uintptr_t(::sysconf(_SC_PAGESIZE));
    return reinterpret_cast<std::byte*>(reinterpret_cast<uintptr_t>(address) / page * page);
}

/// Whether the system may not take it away: such pages cannot be called cold either.
bool is_locked(const void* address)
{
    return ::madvise(page_of(address), 1, MADV_COLD) != 0 && errno == EINVAL;
}

/// Whether this process may lock that many bytes in memory.
bool may_lock(size_t bytes)
{
    std::vector<std::byte> some(bytes);
    if (::mlock(some.data(), bytes) != 0) return false;
    const bool is_true = is_locked(some.data() + bytes / 2);  // sanitizers make nothing of the call
    ::munlock(some.data(), bytes);
    return is_true;
}

/// Takes the program's code out of the process's memory, as the system does where that is short.
void forget_code()
{
    const auto forget = [](dl_phdr_info* program, size_t, void*) {
        for (size_t i = 0; i < program->dlpi_phnum; ++i) {
            const auto& segment = program->dlpi_phdr[i];
            if (segment.p_type != PT_LOAD || !(segment.p_flags & PF_X)) continue;
            std::byte* const begin = page_of(reinterpret_cast<void*>(program->dlpi_addr + segment.p_vaddr));
            static_cast<void>(::madvise(begin, segment.p_memsz, MADV_DONTNEED));  // not where a servo keeps it
        }
        return 1;  // libraries follow
    };
    ::dl_iterate_phdr(forget, nullptr);
}

/// Time goes on by waiting; counts the faults of the thread's ticks.
class CountingPacing : public Pacing {
public:
    struct Counts {
        std::atomic<bool> may_begin{false}, is_done{false};
        uint64_t faults = 0;
    };
    CountingPacing(Counts& counts, uint64_t ticks) : counts_(counts), ticks_(ticks) {}
    uint64_t now_ns() noexcept override { return now_ns_; }
    void wait_until(uint64_t deadline_ns) noexcept override
    {
        while (!counts_.may_begin) std::this_thread::yield();
        now_ns_ = deadline_ns;
        if (tick_ == 0) before_ = faults();
        if (tick_++ == ticks_) {
            counts_.faults = faults() - before_;
            counts_.is_done = true;
        }
    }

private:
    static uint64_t faults()
    {
        rusage usage{};
        ::getrusage(RUSAGE_THREAD, &usage);
        return uint64_t(usage.ru_minflt) + uint64_t(usage.ru_majflt);
    }
    Counts& counts_;
    uint64_t ticks_;
    uint64_t now_ns_ = 1'000'000'000, tick_ = 0, before_ = 0;
};

/// A hand that comes to a rod along x after a thousand ticks in the air.
class ComingHand : public HapticDevice {
public:
    DeviceCaps caps() const noexcept override { return {.outputs_force = false}; }
    ReadResult read(DeviceState& state) noexcept override
    {
        ++reads_;
        state = {};
        state.time_ns = reads_ * MILLISECOND;
        state.sequence = uint32_t(reads_);
        const double way = std::clamp((double(reads_) - 1000.0) / 500.0, 0.0, 1.0);
        state.position_m = {0.0, 0.005 * (way - 1.0), 0.0};
        return ReadResult::fresh;
    }
    bool write(const glm::dvec3&, uint32_t) noexcept override { return true; }

private:
    uint64_t reads_ = 0;
};

}  // namespace

TEST_CASE("no tick waits for a page, the first touch included, and none can be taken away")
{
    const bool may_keep = may_lock(sizeof(Servo) + sizeof(GrowthMemory) + (size_t{1} << 20));
    CountingPacing::Counts counts;
    forget_code();
    Servo servo(std::make_unique<ComingHand>(), std::make_unique<CountingPacing>(counts, 4000),
                {.rate_hz = 1000, .realtime = false});
    ForceSettings settings{.assistance = true, .probe_radius = 2.5, .mode = TouchMode::object};
    settings.workspace = {glm::dmat3(1000.0), glm::dvec3(8.0)};
    servo.settings().publish(settings);
    RelevancePatch& patch = servo.relevance().writing();
    const Rod rod{.point = {8.0, 8.4, 8.0}, .radius = 1.0};
    fill_patch(patch, {0, 0, 0}, {64, 64, 64}, glm::dvec3(0.25), [&](const glm::dvec3& p) { return rod.holds(p); });
    patch.volume_size = {64, 64, 64};
    patch.time_ns = ~uint64_t{0};  // never old
    servo.relevance().publish();
    counts.may_begin = true;
    while (!counts.is_done) std::this_thread::yield();
    CHECK(counts.faults == 0);
    while (!servo.state().take()) std::this_thread::yield();
    CHECK(servo.state().value().step.in_contact);
    if (!may_keep) {
        MESSAGE("this process may keep no memory");
        return;
    }
    CHECK(is_locked(&servo));
    CHECK(is_locked(&patch));
}

TEST_CASE("kept memory is there, cannot be taken away, and can be once nobody keeps it")
{
    constexpr size_t BYTES = size_t{1} << 20;
    auto* const begin =
        static_cast<std::byte*>(::mmap(nullptr, BYTES, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    REQUIRE(begin != MAP_FAILED);
    {
        const KeptMemory kept(begin + 5000, BYTES - 10'000);
        std::vector<unsigned char> there(BYTES / size_t(::sysconf(_SC_PAGESIZE)));
        REQUIRE(::mincore(begin, BYTES, there.data()) == 0);
        CHECK((there[0] & 1) == 0);
        for (size_t page = 1; page + 2 < there.size(); ++page) REQUIRE((there[page] & 1) == 1);
        if (may_lock(BYTES)) {
            CHECK(kept.is_kept());
            CHECK(is_locked(begin + BYTES / 2));
        }
    }
    CHECK_FALSE(is_locked(begin + BYTES / 2));
    ::munmap(begin, BYTES);
}

TEST_CASE("where the system keeps nothing, that is said")
{
    if (::geteuid() == 0) {
        MESSAGE("an administrator's process may keep all");
        return;
    }
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_MEMLOCK, &before) == 0);
    const rlimit none{0, before.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_MEMLOCK, &none) == 0);
    std::vector<std::byte> some(size_t{1} << 20);
    const KeptMemory kept(some.data(), some.size());
    CHECK_FALSE(kept.is_kept());
    REQUIRE(::setrlimit(RLIMIT_MEMLOCK, &before) == 0);
}
