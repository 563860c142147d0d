// The remote engine: runs every call as a job on the server.

#include "engine/job_queue.hpp"
#include "engine/request.hpp"
#include "engine/ticket_lock.hpp"
#include "octopair/client.hpp"
#include "service/client/connection.hpp"
#include "service/client/remote_job.hpp"

namespace octopair {

namespace {

class ClientEngine final : public Engine {
public:
    ClientEngine(std::string_view address, const ClientOptions& options) : connection_(address, options) {
        connection_.check_server();
    }

private:
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) override {
        const TicketLock::Guard turn(turns_, control.stop);
        return service::find_remotely(connection_, request, output, control);
    }
    detail::JobQueue& jobs() override { return jobs_; }

    TicketLock turns_;
    service::Connection connection_;
    detail::JobQueue jobs_{*this};  // last, so that its thread ends before the other members are destroyed
};

}  // namespace

std::unique_ptr<Engine> connect(std::string_view address, const ClientOptions& options) {
    return std::make_unique<ClientEngine>(address, options);
}

}  // namespace octopair
