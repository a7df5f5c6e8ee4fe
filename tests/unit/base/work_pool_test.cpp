#include "engine/base/waits/work_pool.h"

#include <atomic>
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "tests/support/volume_files.h"

using namespace shvr;
using namespace shvr::test;

TEST_CASE("every task of a batch runs once, and what one fails with is thrown")
{
    WorkPool pool(3);
    std::vector<std::atomic<int>> runs(1000);
    pool.run(1000, [&](int64_t task, int worker) {
        CHECK_UNARY(worker >= 0 && worker < pool.workers());
        ++runs[size_t(task)];
    });
    for (const auto& count : runs) REQUIRE(count == 1);
    pool.run(0, [](int64_t, int) { fail("not called"); });

    std::atomic<int> later = 0;
    const std::string said = error_of([&] {
        pool.run(100000, [&](int64_t task, int) {
            if (task == 5) fail("task 5");
            if (task > 5) std::this_thread::sleep_for(std::chrono::microseconds(100));
            ++later;
        });
    });
    CHECK(said == "task 5");
    CHECK(later < 99999);
    pool.run(10, [&](int64_t, int) {});  // it goes on
}

TEST_CASE("urgent batches go before others, and who waits may end them")
{
    int polls_left = 1000000;
    WorkPool pool(1, [&] {
        if (--polls_left == 0) fail("enough");
    });
    std::vector<int> order;
    std::atomic<bool> goes_on = false;
    const auto first = pool.start(1, [&](int64_t, int) {
        while (!goes_on) std::this_thread::yield();
    });
    const auto normal = pool.start(2, [&](int64_t, int) { order.push_back(1); });
    const auto urgent = pool.start(
        2, [&](int64_t, int) { order.push_back(2); }, WorkPool::Urgency::urgent);
    goes_on = true;
    pool.wait(first);
    pool.wait(urgent);
    pool.wait(normal);
    CHECK(order == std::vector<int>{2, 2, 1, 1});

    std::atomic<int> done = 0;
    polls_left = 2;
    CHECK(error_of([&] {
              pool.run(1000000, [&](int64_t, int) {
                  std::this_thread::sleep_for(std::chrono::milliseconds(1));
                  ++done;
              });
          }) == "enough");
    const int at_return = done;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    CHECK(done == at_return);
}

TEST_CASE("who waits for many short batches is asked as often as who waits for a long one")
{
    int polls = 0;
    WorkPool pool(1, [&] { ++polls; });
    const auto begin = std::chrono::steady_clock::now();
    int batches = 0;
    while (polls < 5) {
        pool.run(1, [](int64_t, int) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
        REQUIRE(++batches < 1000);  // 50 an interval at most
    }
    CHECK(std::chrono::steady_clock::now() - begin >= 5 * std::chrono::milliseconds(50));
}

TEST_CASE("what is called before every task drops those that have not begun, for whoever waits")
{
    std::atomic<bool> stop = false;
    WorkPool pool(2, {}, [&] {
        if (stop) fail("stopped");
    });
    std::atomic<int> begun = 0;
    const std::string said = error_of([&] {
        pool.run(1000, [&](int64_t, int) {
            if (++begun == 10) stop = true;
        });
    });
    CHECK(said == "stopped");
    CHECK(begun <= 11);
    CHECK(error_of([&] { pool.run(1, [&](int64_t, int) { ++begun; }); }) == "stopped");
    CHECK(begun <= 11);
}
