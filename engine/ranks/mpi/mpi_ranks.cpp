#include "engine/ranks/mpi/mpi_ranks.h"

#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include <array>
#include <chrono>
#include <cstring>
#include <limits>
#include <utility>

#include "engine/base/error.h"

// A mail travels as a head (how many values follow, and the text) and its values. Errors of MPI end all processes with
// MPI's own message, as MPI does by default.

namespace shvr {

namespace {

/// Tags: box + HEAD, box + VALUES.
constexpr int HEAD = 0, VALUES = 2;
constexpr std::array BOXES = {Ranks::Box::desk, Ranks::Box::worker};
/// How long the post office sleeps while no mail moves: MPI has no call that waits without occupying a processor.
constexpr std::chrono::microseconds SHORTEST_SLEEP{50}, LONGEST_SLEEP{1000};

bool is_done(MPI_Request& request)
{
    int done = 0;
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    return done != 0;
}

}  // namespace

struct MpiRanks::Outgoing {
    std::vector<char> head;
    std::vector<float> values;
    std::array<MPI_Request, 2> requests{MPI_REQUEST_NULL, MPI_REQUEST_NULL};
};

struct MpiRanks::Incoming {
    Box box;
    Mail mail;
    MPI_Request request = MPI_REQUEST_NULL;
};

MpiRanks::MpiRanks() : Ranks(0, 1)
{
    std::promise<void> met;
    std::future<void> all_met = met.get_future();
    office_ = std::thread([this, &met] { run(met); });
    all_met.get();
}

MpiRanks::~MpiRanks()
{
    MpiRanks::end();
}

void MpiRanks::end()
{
    if (!office_.joinable()) return;
    {
        const std::scoped_lock lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_one();
    office_.join();
}

void MpiRanks::carry(int to, Box box, Mail mail)
{
    SHVR_CHECK(mail.values.size() <= size_t(std::numeric_limits<int>::max()), mail.values.size());
    {
        const std::scoped_lock lock(mutex_);
        waiting_.push_back({to, box, std::move(mail)});
    }
    changed_.notify_one();
}

void MpiRanks::run(std::promise<void>& met)
{
    int given = 0, index = 0, count = 1;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given);
    MPI_Comm_rank(MPI_COMM_WORLD, &index);
    MPI_Comm_size(MPI_COMM_WORLD, &count);
    set_place(index, count);
    met.set_value();
    auto sleep = SHORTEST_SLEEP;
    while (true) {
        const bool has_sent = send_waiting(), has_received = receive();
        std::unique_lock lock(mutex_);
        if (is_ending_ && waiting_.empty() && outgoing_.empty() && incoming_.empty()) break;
        sleep = has_sent || has_received ? SHORTEST_SLEEP : std::min(2 * sleep, LONGEST_SLEEP);
        changed_.wait_for(lock, sleep, [this] { return !waiting_.empty(); });
    }
    MPI_Finalize();
}

/// Starts sending what waits, and forgets what has been sent. Returns whether anything happened.
bool MpiRanks::send_waiting()
{
    std::deque<Addressed> waiting;
    {
        const std::scoped_lock lock(mutex_);
        waiting.swap(waiting_);
    }
    for (Addressed& each : waiting) {
        Outgoing& sent = outgoing_.emplace_back();
        sent.values = std::move(each.mail.values);
        const uint64_t count = sent.values.size();
        sent.head.resize(sizeof count + each.mail.text.size());
        std::memcpy(sent.head.data(), &count, sizeof count);
        std::memcpy(sent.head.data() + sizeof count, each.mail.text.data(), each.mail.text.size());
        MPI_Isend(sent.head.data(), int(sent.head.size()), MPI_CHAR, each.to, int(each.box) + HEAD, MPI_COMM_WORLD,
                  &sent.requests[0]);
        if (count > 0)
            MPI_Isend(sent.values.data(), int(count), MPI_FLOAT, each.to, int(each.box) + VALUES, MPI_COMM_WORLD,
                      &sent.requests[1]);
    }
    const size_t before = outgoing_.size();
    outgoing_.remove_if([](Outgoing& sent) { return is_done(sent.requests[0]) && is_done(sent.requests[1]); });
    return !waiting.empty() || outgoing_.size() < before;
}

/// Starts receiving what has been sent, and delivers what has arrived whole, in order. Returns whether anything
/// happened.
bool MpiRanks::receive()
{
    bool has_received = false;
    for (const Box box : BOXES) {
        int is_there = 0;
        MPI_Message message{};
        MPI_Status status{};
        MPI_Improbe(MPI_ANY_SOURCE, int(box) + HEAD, MPI_COMM_WORLD, &is_there, &message, &status);
        if (!is_there) continue;
        has_received = true;
        int bytes = 0;
        MPI_Get_count(&status, MPI_CHAR, &bytes);
        uint64_t count = 0;
        std::vector<char> head(static_cast<size_t>(bytes));
        MPI_Mrecv(head.data(), bytes, MPI_CHAR, &message, MPI_STATUS_IGNORE);
        SHVR_CHECK(head.size() >= sizeof count, head.size());
        std::memcpy(&count, head.data(), sizeof count);
        Incoming& arriving = incoming_.emplace_back();
        arriving.box = box;
        arriving.mail.from = status.MPI_SOURCE;
        arriving.mail.text.assign(head.begin() + sizeof count, head.end());
        arriving.mail.values.resize(count);
        if (count > 0)
            MPI_Irecv(arriving.mail.values.data(), int(count), MPI_FLOAT, status.MPI_SOURCE, int(box) + VALUES,
                      MPI_COMM_WORLD, &arriving.request);
    }
    while (!incoming_.empty() && is_done(incoming_.front().request)) {
        has_received = true;
        deliver(incoming_.front().box, std::move(incoming_.front().mail));
        incoming_.pop_front();
    }
    return has_received;
}

}  // namespace shvr
