// The transport by libcurl. One thread runs all transfers of the process, so that they share connections (with HTTP/2
// one connection carries several requests at once) and DNS results. The requesting threads wait for it.

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <list>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/waits/waits.h"
#include "engine/remote/curl_transfer.h"
#include "engine/remote/deadlines.h"

namespace shvr {

namespace {

constexpr long CONNECTIONS_TO_HOST = 16, CONNECTIONS = 32;
/// Interval at which a waiting thread checks `wait_is_over`.
constexpr std::chrono::milliseconds TICK{20};

class CurlTransport final : public Transport {
public:
    CurlTransport() : is_proxied_(may_use_proxy())
    {
        if (curl_global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK) fail("libcurl: cannot be initialized");
        multi_ = curl_multi_init();
        if (multi_ == nullptr) throw std::bad_alloc();
        curl_multi_setopt(multi_, CURLMOPT_MAX_HOST_CONNECTIONS, CONNECTIONS_TO_HOST);
        curl_multi_setopt(multi_, CURLMOPT_MAX_TOTAL_CONNECTIONS, CONNECTIONS);
        curl_multi_setopt(multi_, CURLMOPT_PIPELINING, long(CURLPIPE_MULTIPLEX));
        thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
    }
    ~CurlTransport() override
    {
        thread_.request_stop();
        curl_multi_wakeup(multi_);
        thread_.join();
        curl_multi_cleanup(multi_);
    }
    CurlTransport(const CurlTransport&) = delete;

    std::vector<RemoteResponse> perform(std::span<const RemoteRequest> requests) const override
    {
        static_cast<void>(deadlines());  // reports invalid variables on the requesting thread
        std::vector<std::shared_ptr<CurlTransfer>> transfers;
        for (const RemoteRequest& request : requests) {
            transfers.push_back(std::make_shared<CurlTransfer>());
            transfers.back()->request = request;
            if (request.keys != nullptr) transfers.back()->keys = *request.keys;
        }
        std::unique_lock lock(mutex_);
        arrived_.insert(arrived_.end(), transfers.begin(), transfers.end());
        curl_multi_wakeup(multi_);
        const auto are_done = [&] {
            return std::ranges::all_of(transfers, [](const auto& transfer) { return transfer->is_done; });
        };
        while (!finished_.wait_for(lock, TICK, are_done)) {
            if (!wait_is_over()) continue;
            for (const auto& transfer : transfers) transfer->is_abandoned = true;
            curl_multi_wakeup(multi_);
            lock.unlock();
            stop_if_wait_is_over();
            lock.lock();
        }
        std::vector<RemoteResponse> responses;
        for (const auto& transfer : transfers) responses.push_back(std::move(transfer->response));
        return responses;
    }

private:
    void work(const std::stop_token& stop)
    {
        while (!stop.stop_requested()) {
            std::deque<std::shared_ptr<CurlTransfer>> arrived;
            {
                const std::scoped_lock lock(mutex_);
                arrived.swap(arrived_);
            }
            for (std::shared_ptr<CurlTransfer>& transfer : arrived) start(std::move(transfer));
            int running = 0;
            curl_multi_perform(multi_, &running);
            finish_some();
            // Times out at intervals, to notice abandoned transfers even if no data arrives.
            curl_multi_poll(multi_, nullptr, 0, running > 0 ? 100 : 1000, nullptr);
        }
        while (!running_.empty()) end(running_.front(), CURLE_ABORTED_BY_CALLBACK);
    }

    void start(std::shared_ptr<CurlTransfer> transfer)
    {
        running_.push_back(transfer);
        transfer->is_proxied = is_proxied_;
        try {
            set_up(*transfer);
            if (curl_multi_add_handle(multi_, transfer->handle) != CURLM_OK) throw std::bad_alloc();
        } catch (const std::bad_alloc&) {
            end(transfer, CURLE_OUT_OF_MEMORY);
        }
    }

    void finish_some()
    {
        int left = 0;
        while (const CURLMsg* const message = curl_multi_info_read(multi_, &left)) {
            if (message->msg != CURLMSG_DONE) continue;
            const CURLcode code = message->data.result;  // a copy: the message is invalid once its handle is removed
            const CURL* const handle = message->easy_handle;
            const auto found =
                std::ranges::find_if(running_, [&](const auto& transfer) { return transfer->handle == handle; });
            if (found != running_.end()) end(*found, code);
        }
    }

    /// Takes the pointer by value: a reference would point into running_, from which the transfer is erased.
    void end(std::shared_ptr<CurlTransfer> transfer, CURLcode code)
    {
        std::erase(running_, transfer);
        if (transfer->handle != nullptr) curl_multi_remove_handle(multi_, transfer->handle);
        conclude(*transfer, code);
        const std::scoped_lock lock(mutex_);
        transfer->is_done = true;
        finished_.notify_all();
    }

    CURLM* multi_ = nullptr;
    bool is_proxied_;
    mutable std::mutex mutex_;
    mutable std::condition_variable finished_;
    mutable std::deque<std::shared_ptr<CurlTransfer>> arrived_;
    std::list<std::shared_ptr<CurlTransfer>> running_;  ///< used by the thread only
    std::jthread thread_;
};

}  // namespace

std::shared_ptr<const Transport> network()
{
    static const std::shared_ptr<const Transport> shared = std::make_shared<CurlTransport>();
    return shared;
}

}  // namespace shvr
