// Desk and workers, with ranks that are threads of this process.

#include <latch>
#include <memory>
#include <numeric>
#include <thread>

#include <doctest/doctest.h>

#include "engine/base/error.h"
#include "engine/ranks/picture_desk.h"
#include "engine/ranks/picture_worker.h"

using namespace shvr;

namespace {

class ThreadRanks final : public Ranks {
public:
    ThreadRanks(int index, std::vector<std::unique_ptr<ThreadRanks>>& all, int count) : Ranks(index, count), all_(all)
    {}

private:
    void carry(int to, Box box, Mail mail) override { all_[size_t(to)]->deliver(box, std::move(mail)); }

    std::vector<std::unique_ptr<ThreadRanks>>& all_;
};

constexpr int64_t WIDTH = 3, HEIGHT = 64;

ImageF rows_of(const RowStrip& strip)
{
    ImageF rows{int(WIDTH), int(strip.upper - strip.lower), {}};
    rows.rgba.resize(size_t(4 * WIDTH * (strip.upper - strip.lower)));
    std::iota(rows.rgba.begin(), rows.rgba.end(), float(4 * WIDTH * strip.lower));
    return rows;
}

using Draw = std::function<void(PictureWorker& worker, int rank, const RowStrip& strip)>;

void send(PictureWorker& worker, const RowStrip& strip)
{
    worker.send(strip.lower, rows_of(strip));
}

void work(Ranks& ranks, const Draw& draw)
{
    PictureWorker worker(ranks);
    try {
        while (const std::optional<RowStrip> strip = worker.next()) draw(worker, ranks.index(), *strip);
        worker.end_done(sentence("report of ", ranks.index()));
    } catch (const std::exception& error) {
        worker.end_failed(error.what());
    }
}

struct Made {
    std::vector<float> values;
    std::vector<std::string> reports;
    std::string failure;
    int64_t peak_waiting_rows = 0;
};

Made made_by(int count, const Draw& draw, int64_t window_rows = HEIGHT, int64_t rows_at_once = HEIGHT,
             const std::function<void()>& before_rows = {})
{
    std::vector<std::unique_ptr<ThreadRanks>> all;
    for (int rank = 0; rank < count; ++rank) all.push_back(std::make_unique<ThreadRanks>(rank, all, count));
    std::vector<std::jthread> others;
    for (int rank = 1; rank < count; ++rank)
        others.emplace_back([&all, &draw, rank] { work(*all[size_t(rank)], draw); });
    Made made;
    PictureDesk desk(*all[0], {HEIGHT, {}, count, rows_at_once}, {WIDTH, HEIGHT, window_rows}, [&](const ImageF& rows) {
        if (before_rows) before_rows();
        made.values.insert(made.values.end(), rows.rgba.begin(), rows.rgba.end());
    });
    work(*all[0], draw);
    try {
        made.reports = desk.finish();
    } catch (const Error& error) {
        made.failure = error.what();
    }
    made.peak_waiting_rows = desk.peak_waiting_rows();
    return made;
}

}  // namespace

TEST_CASE("rows of any number of ranks arrive in order")
{
    for (const int count : {1, 2, 3, 5, 17}) {
        CAPTURE(count);
        const Made made =
            made_by(count, [](PictureWorker& worker, int, const RowStrip& strip) { send(worker, strip); });
        CHECK(made.failure.empty());
        CHECK(made.values == rows_of({0, HEIGHT}).rgba);
        REQUIRE(made.reports.size() == size_t(count));
        for (int rank = 0; rank < count; ++rank) CHECK(made.reports[size_t(rank)] == sentence("report of ", rank));
    }
}

TEST_CASE("rows that arrive early wait for those above them")
{
    std::latch later_sent(1);
    const Made made = made_by(2, [&](PictureWorker& worker, int, const RowStrip& strip) {
        if (strip.lower == 0) later_sent.wait();
        send(worker, strip);
        if (strip.lower > 0 && !later_sent.try_wait()) later_sent.count_down();
    });
    CHECK(made.values == rows_of({0, HEIGHT}).rgba);
    CHECK(made.peak_waiting_rows > HEIGHT / 4);
}

TEST_CASE("rows too far ahead are not handed out")
{
    constexpr int64_t WINDOW = 12, AT_ONCE = 6;  // strips of 2 rows, in rounds of 6
    std::latch window_full(1);
    const Made made = made_by(
        3,
        [&](PictureWorker& worker, int, const RowStrip& strip) {
            // The first rows come after the last ones that the window allows.
            if (strip.lower == 0) window_full.wait();
            send(worker, strip);
            if (strip.upper == WINDOW) window_full.count_down();
        },
        WINDOW, AT_ONCE);
    CHECK(made.values == rows_of({0, HEIGHT}).rgba);
    CHECK(made.peak_waiting_rows <= WINDOW);
}

TEST_CASE("a failure of any rank ends all, with its sentence")
{
    for (const int failing : {0, 1, 4}) {
        CAPTURE(failing);
        const Made made = made_by(5, [&](PictureWorker& worker, int rank, const RowStrip& strip) {
            if (rank != failing) {
                // The others draw until they are told to end: no strip is ever finished.
                while (!worker.is_ended()) std::this_thread::yield();
                return;
            }
            fail("rank ", rank, " cannot read row ", strip.lower);
        });
        CHECK(made.failure.starts_with(sentence("rank ", failing, " cannot read row ")));
        CHECK(made.values.empty());
    }
}

TEST_CASE("a picture that cannot be written ends all ranks")
{
    const Made made = made_by(
        3, [](PictureWorker& worker, int, const RowStrip& strip) { send(worker, strip); }, HEIGHT, 1,
        [] { fail("the disk is full"); });
    CHECK(made.failure == "the disk is full");
}

TEST_CASE("a rank 0 that fails before it has a desk ends the others")
{
    std::vector<std::unique_ptr<ThreadRanks>> all;
    for (int rank = 0; rank < 3; ++rank) all.push_back(std::make_unique<ThreadRanks>(rank, all, 3));
    bool has_drawn = false;
    {
        std::jthread one([&] { work(*all[1], [&](PictureWorker&, int, const RowStrip&) { has_drawn = true; }); });
        std::jthread two([&] { PictureWorker(*all[2]).end_failed("too"); });
        end_other_ranks(*all[0]);
    }
    CHECK_FALSE(has_drawn);
}
