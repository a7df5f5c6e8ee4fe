#include "engine/remote/remote_folder.h"

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/base/waits/waits.h"
#include "engine/remote/address.h"
#include "engine/remote/deadlines.h"
#include "engine/remote/redirects.h"

namespace shvr {

namespace {

using State = RemoteObject::State;

constexpr int MAX_REDIRECTS = 5;
/// Upper limit of a pause before a retry, even if the server asks for a longer one.
constexpr double MAX_PAUSE_S = 30.0;
/// After a server was unreachable, cached objects are used without asking it for this time.
constexpr int64_t OFFLINE_MS = 30'000;

bool asks_to_try_again(int status)
{
    return status == 408 || status == 429 || (status >= 500 && status != 501 && status != 505);
}

double share_at_random()
{
    thread_local std::minstd_rand random(std::random_device{}());
    return std::uniform_real_distribution<double>(0.5, 1.0)(random);
}

int64_t now_ms()
{
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

void pause(double seconds)
{
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (Clock::now() < end) {
        stop_if_wait_is_over();
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
}

std::string after_tries(int64_t tries)
{
    return sentence(", after ", tries, tries == 1 ? " try" : " tries");
}

}  // namespace

/// A want that is being asked for.
struct RemoteFolder::Asking {
    const RemoteWant& want;
    RemoteObject& object;
    std::string url{};
    std::string name{};
    int redirects = 0;
    int64_t tries = 0;
    bool refuses_local = false;
    bool is_done = false;
    bool was_unchanged = false;  ///< whether the server confirmed that the cached object is current
    double pause_s = 0.0;        ///< before the next try
    std::optional<CachedObject> cached{};

    /// Whether an object is cached with an ETag, so that the server need only confirm it.
    bool is_kept() const { return cached && !cached->is_missing && !cached->etag.empty(); }
    void end(State state, const std::string& failure = {})
    {
        object.state = state;
        object.failure = failure.empty() ? failure : name + ": " + failure;
        is_done = true;
    }
    void end_with_cached()
    {
        object.bytes = std::move(cached->bytes);
        object.etag = std::move(cached->etag);
        object.object_bytes = cached->object_bytes;
        end(cached->is_missing ? State::missing : State::found);
    }
};

RemoteFolder::RemoteFolder(std::string address) : RemoteFolder(std::move(address), network(), {}, &object_cache()) {}

RemoteFolder::RemoteFolder(std::string address, std::shared_ptr<const Transport> transport, RetryPace pace,
                           const ObjectCache* cache)
    : address_(std::move(address)), transport_(std::move(transport)), pace_(pace), cache_(cache)
{
    while (address_.ends_with('/')) address_.pop_back();
    const Address parsed = parse_address(address_);
    is_s3_ = parsed.scheme == Scheme::s3;
    if (is_s3_) {
        S3Place place = s3_place(parsed);
        url_ = std::move(place.url);
        keys_ = std::move(place.keys);
    } else {
        url_ = url_of(parsed);
        query_ = query_for(parsed);
    }
}

std::string RemoteFolder::name_of(const std::string& key) const
{
    return key.empty() ? address_ : address_ + "/" + key;
}

std::string RemoteFolder::url_of_key(const std::string& key) const
{
    std::string url = key.empty() ? url_ : url_ + "/" + encoded_key(key);
    return query_.empty() ? url : url + "?" + query_;
}

std::string RemoteFolder::cached_name(const RemoteWant& want) const
{
    const std::string url = want.key.empty() ? url_ : url_ + "/" + encoded_key(want.key);
    return want.part ? sentence(url, " ", want.part->first, " ", want.part->bytes) : url;
}

bool RemoteFolder::is_offline() const
{
    const int64_t unreached = *unreached_ms_;
    return unreached >= 0 && now_ms() - unreached < OFFLINE_MS;
}

void RemoteFolder::look_up(Asking& asking) const
{
    const RemoteWant& want = asking.want;
    if (cache_ == nullptr) return;
    asking.cached = cache_->find(cached_name(want), want.part ? want.part->bytes : want.max_bytes);
    if (!asking.cached || !is_offline()) return;
    asking.object.is_offline = true;
    asking.end_with_cached();
}

void RemoteFolder::keep(const Asking& asking) const
{
    const RemoteObject& object = asking.object;
    const bool is_missing = object.state == State::missing;
    if (cache_ == nullptr || object.is_offline || !(is_missing || object.state == State::found)) return;
    if (is_missing && asking.cached && asking.cached->is_missing) return;
    cache_->keep(
        cached_name(asking.want),
        {.is_missing = is_missing, .etag = object.etag, .object_bytes = object.object_bytes, .bytes = object.bytes});
}

std::vector<RemoteObject> RemoteFolder::get(std::span<const RemoteWant> wants) const
{
    std::vector<RemoteObject> objects(wants.size());
    std::vector<Asking> askings;
    for (size_t i = 0; i < wants.size(); ++i)
        askings.push_back(
            {.want = wants[i], .object = objects[i], .url = url_of_key(wants[i].key), .name = name_of(wants[i].key)});
    for (Asking& asking : askings) look_up(asking);
    for (;;) {
        std::vector<Asking*> open;
        std::vector<RemoteRequest> requests;
        double pause_s = 0.0;
        for (Asking& asking : askings) {
            if (asking.is_done) continue;
            pause_s = std::max(pause_s, std::exchange(asking.pause_s, 0.0));
            open.push_back(&asking);
            const RemoteWant& want = asking.want;
            requests.push_back({.url = asking.url,
                                .range = want.part,
                                .unless_etag = asking.is_kept() ? asking.cached->etag : std::string(),
                                .max_bytes = want.part ? want.part->bytes : want.max_bytes,
                                .keys = keys_ ? &*keys_ : nullptr,
                                .refuses_local = asking.refuses_local});
        }
        if (open.empty()) return objects;
        if (pause_s > 0.0) pause(pause_s);
        std::vector<RemoteResponse> responses = transport_->perform(requests);
        for (size_t i = 0; i < open.size(); ++i) {
            judge(*open[i], std::move(responses[i]));
            if (open[i]->is_done && !open[i]->was_unchanged) keep(*open[i]);
        }
    }
}

void RemoteFolder::judge(Asking& asking, RemoteResponse&& response) const
{
    const int status = response.status;
    const bool may_pass = status == 0 ? response.may_pass : asks_to_try_again(status);
    const int64_t tries = response.is_unreached && is_offline() ? 1 : deadlines().tries;
    if (may_pass && ++asking.tries < tries) {
        const double longest =
            std::min(pace_.most_s, pace_.first_s * double(int64_t{1} << std::min<int64_t>(asking.tries - 1, 20)));
        asking.pause_s = std::max(longest * share_at_random(), std::min(response.retry_after_s, MAX_PAUSE_S));
        return;
    }
    if (status == 0) {
        asking.object.is_unreached = response.is_unreached;
        if (response.is_unreached) *unreached_ms_ = now_ms();
        if (response.is_unreached && asking.cached) {
            asking.object.is_offline = true;
            return asking.end_with_cached();
        }
        return asking.end(State::failed,
                          "cannot be read: " + response.failure + (may_pass ? after_tries(asking.tries) : ""));
    }
    switch (status) {
        case 200:
        case 206: return take(asking, std::move(response));
        case 304:
            if (asking.is_kept()) {
                asking.was_unchanged = true;
                return asking.end_with_cached();
            }
            return asking.end(State::failed, "is said to be unchanged, which was not asked");
        case 301:
        case 302:
        case 303:
        case 307:
        case 308: return redirect(asking, response);
        case 404:
        case 410: return asking.end(State::missing);
        case 401:
        case 403:
            return asking.end(
                State::forbidden,
                sentence("access is refused (status ", status,
                         "), or the object is missing and its "
                         "bucket may not be listed; expected ",
                         is_s3_ && !keys_  ? "keys in AWS_ACCESS_KEY_ID or ~/.aws, of which none were found"
                         : is_s3_          ? "keys that may read it"
                         : !query_.empty() ? "a query that is still valid"
                                           : "an address that may be read without a password, or one "
                                             "with its signed query"));
        case 416: return asking.end(State::failed, "has fewer bytes than its index says; expected a whole object");
        default: break;
    }
    asking.end(State::failed,
               sentence("the server answers with status ", status, may_pass ? after_tries(asking.tries) : std::string(),
                        "; expected the object, status 200"));
}

void RemoteFolder::redirect(Asking& asking, const RemoteResponse& response) const
{
    if (is_s3_)
        return asking.end(
            State::failed,
            response.region.empty()
                ? std::string("the server redirects; expected the endpoint of the bucket in AWS_ENDPOINT_URL")
                : sentence("its bucket is in another region, ", printable(response.region),
                           "; expected that one in AWS_REGION"));
    if (++asking.redirects > MAX_REDIRECTS)
        return asking.end(State::failed, sentence("is redirected more than ", MAX_REDIRECTS, " times; expected fewer"));
    try {
        const Redirect next = redirect_of(asking.name, asking.url, response.location, response.is_from_local);
        asking.url = next.url;
        asking.refuses_local = asking.refuses_local || next.refuses_local;
    } catch (const Error& error) {
        asking.object.state = State::failed;
        asking.object.failure = error.what();
        asking.is_done = true;
    }
}

void RemoteFolder::take(Asking& asking, RemoteResponse&& response) const
{
    const RemoteWant& want = asking.want;
    RemoteObject& object = asking.object;
    object.etag = std::move(response.etag);
    object.bytes = std::move(response.body);
    if (!want.part) {
        if (response.status != 200)
            return asking.end(State::failed, "only a part of it is sent; expected the whole object");
        object.object_bytes = int64_t(object.bytes.size());
        return asking.end(State::found);
    }
    if (response.status != 206)
        return asking.end(State::failed,
                          "the server sends the whole object instead of a part; expected one that answers "
                          "requests for ranges, with status 206");
    const ByteRange& part = *want.part;
    object.object_bytes = response.object_bytes.value_or(-1);
    if (object.object_bytes >= 0 && object.object_bytes < part.bytes)
        return asking.end(State::failed,
                          sentence("holds ", object.object_bytes, " bytes; expected at least ", part.bytes));
    const int64_t first = part.first >= 0 ? part.first : object.object_bytes - part.bytes;
    if (int64_t(object.bytes.size()) != part.bytes || response.range_first != first)
        return asking.end(State::failed, sentence("the server sends ", object.bytes.size(), " bytes from byte ",
                                                  response.range_first.value_or(-1), " on; expected ", part.bytes,
                                                  " from byte ", first));
    asking.end(State::found);
}

}  // namespace shvr
