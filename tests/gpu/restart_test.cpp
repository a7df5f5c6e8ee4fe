// A device that is re-created, as after a device loss, while another thread reads the next volume.

#include <atomic>
#include <thread>

#include <doctest/doctest.h>

#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE("a volume that is being read on a worker gets its levels while the device is made anew")
{
    Renderer renderer({.device = {}, .budget = {.device_bytes = uint64_t{64} << 20, .host_bytes = 0}, .threads = 1});
    const std::shared_ptr<const VolumeSource> source = source_of(noise_volume(glm::ivec3(40), 3));
    std::atomic<bool> may_end = false;
    std::atomic<int> rounds = 0, wrong = 0;
    std::thread worker([&] {
        while (!may_end) {
            if (renderer.with_levels(source, {}, false) != source) ++wrong;  // which fits as it is
            ++rounds;
        }
    });
    while (rounds < 10) std::this_thread::yield();
    for (int times = 0; times < 5; ++times) renderer.restart();
    may_end = true;
    worker.join();
    CHECK(wrong == 0);
}
