#pragma once
// Reads objects below an address, by HTTP requests with retries and redirects. Nothing is listed or written there. Any
// thread may call these; a thread waits for its own requests, until waits are over (engine/base/waits/waits.h).
//
// Objects are kept in a cache on disk (object_cache.h). A server is asked whether a kept object is still the same, by
// its ETag, and then sends no bytes. If no server answers, the kept object is taken, and for half a minute all others
// are taken without asking.

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/remote/object_cache.h"
#include "engine/remote/s3.h"
#include "engine/remote/transport.h"

namespace shvr {

struct RemoteWant {
    std::string key{};                ///< relative to the address; empty: the address itself
    std::optional<ByteRange> part{};  ///< null: the whole object
    int64_t max_bytes = 0;            ///< most bytes of a whole object; a part has exactly its own
};

struct RemoteObject {
    enum class State {
        found,
        missing,    ///< 404
        forbidden,  ///< 401, 403: without the right to list, a bucket answers so for missing objects too
        failed
    };
    State state = State::failed;
    std::vector<std::byte> bytes{};
    std::string etag{};
    int64_t object_bytes = -1;  ///< size of the whole object; below 0: unknown
    std::string failure{};      ///< one sentence that names the object, unless found or missing
    bool is_unreached = false;  ///< failed before a server answered
    bool is_offline = false;    ///< from the cache, since no server answered
};

/// Time between tries: twice as long after each, less a random part.
struct RetryPace {
    double first_s = 0.2, most_s = 8.0;
};

class RemoteFolder {
public:
    /// `address`: the text of an address, without a query. Fails if it is no address that can be read.
    explicit RemoteFolder(std::string address);
    /// `cache`: may be null; must outlive this object.
    RemoteFolder(std::string address, std::shared_ptr<const Transport> transport, RetryPace pace,
                 const ObjectCache* cache = nullptr);

    /// The address of an object for messages, without a query.
    std::string name_of(const std::string& key) const;
    const std::string& address() const { return address_; }
    /// Whether requests carry keys or a query. Such objects must not be readable by others.
    bool is_private() const { return keys_.has_value() || !query_.empty(); }

    /// Reads several objects in parallel, in the order of the wants. An object that cannot be read is no exception.
    std::vector<RemoteObject> get(std::span<const RemoteWant> wants) const;

private:
    struct Asking;
    std::string url_of_key(const std::string& key) const;
    void judge(Asking& asking, RemoteResponse&& response) const;
    void redirect(Asking& asking, const RemoteResponse& response) const;
    void take(Asking& asking, RemoteResponse&& response) const;
    std::string cached_name(const RemoteWant& want) const;
    void look_up(Asking& asking) const;
    void keep(const Asking& asking) const;
    bool is_offline() const;

    std::string address_, url_, query_;
    std::optional<SigningKeys> keys_;
    bool is_s3_ = false;
    std::shared_ptr<const Transport> transport_;
    RetryPace pace_;
    const ObjectCache* cache_;
    /// Milliseconds of the steady clock when a server was last not reached; shared by copies.
    std::shared_ptr<std::atomic<int64_t>> unreached_ms_ = std::make_shared<std::atomic<int64_t>>(-1);
};

}  // namespace shvr
