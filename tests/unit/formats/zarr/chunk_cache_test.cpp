#include "engine/formats/zarr/store/chunk_cache.h"

#include <atomic>
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

namespace {

Block block_of(size_t bytes)
{
    return Block(bytes, std::byte{7});
}

}  // namespace

TEST_CASE("a cache of chunks stays within its budget and forgets what was used longest ago")
{
    ChunkCache cache(10000);
    int made = 0;
    const auto get = [&](int64_t chunk) {
        cache.get({0, chunk}, [&] {
            ++made;
            return block_of(3000);
        });
        CHECK(cache.bytes() <= 10000);
    };
    for (const int64_t chunk : {0, 1, 2}) get(chunk);
    get(0);
    CHECK(made == 3);
    get(3);  // evicts 1
    get(0);
    CHECK(made == 4);
    get(1);
    CHECK(made == 5);
    cache.get({1, 0}, [&] { return block_of(20000); });  // larger than the budget: stays until the next one
    CHECK(cache.bytes() >= 20000);
    get(4);
}

TEST_CASE("what many threads want at once is made once")
{
    ChunkCache cache(1 << 20);
    std::atomic<int> made = 0;
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i) {
        threads.emplace_back([&] {
            cache.get({0, 1}, [&] {
                ++made;
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
                return block_of(10);
            });
        });
    }
    threads.clear();
    CHECK(made == 1);
}

TEST_CASE("a chunk that could not be made is tried again")
{
    ChunkCache cache(1 << 20);
    CHECK(error_of([&] { cache.get({0, 1}, []() -> Block { fail("no"); }); }) == "no");
    CHECK(cache.get({0, 1}, [] { return block_of(10); })->size() == 10);
}
