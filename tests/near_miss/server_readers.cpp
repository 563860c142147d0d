// Readers of what servers and their clients need: tokens, roles and addresses.
#include "near_miss/readers.hpp"
#include "service/protocol/address.hpp"
#include "service/protocol/credential_files.hpp"
#include "service/server/net/role_file.hpp"
#include "service/server/net/token_file.hpp"

namespace octopair::test {

void read_tokens(const NearMissFile& file, Values& values) {
    using namespace std::chrono;
    for (const service::Token& token : service::read_token_file(file.path)) {
        values.text(token.name);
        values.text({reinterpret_cast<const char*>(token.digest.data()), token.digest.size()});
        if (!token.until) {
            values.word("always");
        } else if (*token.until == system_clock::time_point::max()) {
            values.word("late");
        } else if (*token.until == system_clock::time_point::min()) {
            values.word("early");
        } else {
            values.whole(floor<seconds>(*token.until).time_since_epoch().count());
        }
    }
}

void read_client_token(const NearMissFile& file, Values& values) { values.text(service::read_token(file.path)); }

void read_roles(const NearMissFile& file, Values& values) {
    const service::Roles roles(file.path);
    for (const std::string& name : roles.clients()) {
        const service::Caller caller = roles.caller(name);
        values.text(name);
        values.word(service::name_of(caller.role));
        values.text(caller.reads);
    }
}

void read_address(const NearMissFile& file, Values& values) {
    const service::Address address = service::parse_address(file.content);
    for (const std::string& part : {address.path, address.host, address.port}) values.text(part);
}

}  // namespace octopair::test
