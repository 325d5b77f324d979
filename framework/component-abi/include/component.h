/* The contract between the Steadfast container and a component library, in C11.
 *
 * A component library exports one data symbol, `steadfast_component`, of type
 * `steadfast_library_descriptor`. It is data, not a function: the container compares magic,
 * version, size and layout hash before a single instruction of the library has been asked to run.
 *
 * This header says the same as the crate `component-abi`; a test of that crate compiles it and
 * compares every size, offset and constant. Tables grow at their end only.
 *
 * A whole component:
 *
 *     static const steadfast_field fields[] = {STEADFAST_FIELD(struct sample, value, F64, "m")};
 *     static const steadfast_type type = STEADFAST_TYPE("Sample", struct sample, fields);
 *     static const steadfast_port ports[] = {STEADFAST_DATA_INPUT("raw", &type)};
 *     STEADFAST_COMPONENT("low-pass", "1.0", ports, .create = create,
 *                         .destroy_instance = destroy, .on_execute = on_execute)
 */
#ifndef STEADFAST_COMPONENT_H
#define STEADFAST_COMPONENT_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* First bytes of every header: "STEADFST", read as a little-endian number. */
#define STEADFAST_ABI_MAGIC UINT64_C(0x5453464441455453)
/* Libraries and containers of different major versions do not work together. */
#define STEADFAST_ABI_MAJOR UINT32_C(1)
/* A library's minor version must not exceed the container's. */
#define STEADFAST_ABI_MINOR UINT32_C(0)

/* ---- Return codes ---------------------------------------------------------------------------- */

/* The answer of every call that crosses the boundary. A callback succeeds with SUCCESS or
 * SUCCESS_SYNC; everything else is a failure. A component may return codes of its own in the
 * UNRECOVERABLE and RECOVERABLE families (family | code). */
typedef uint32_t steadfast_status;

/* Done. */
#define STEADFAST_SUCCESS UINT32_C(200)
/* Done, and synchronously so. */
#define STEADFAST_SUCCESS_SYNC UINT32_C(202)
/* Nothing there: the input holds no new datum, the property is not set. */
#define STEADFAST_NOTHING UINT32_C(204)
/* The caller did something wrong. */
#define STEADFAST_CALLER_ERROR UINT32_C(400)
/* A parameter is wrong: pointer, size, index or type. */
#define STEADFAST_BAD_INPUT_PARAMETER UINT32_C(401)
/* A parameter lies outside its range. */
#define STEADFAST_INPUT_OUT_OF_RANGE UINT32_C(402)
/* A parameter is null. */
#define STEADFAST_INPUT_NULL UINT32_C(403)
/* The caller may not do this: a host service called from a thread of the component's own. */
#define STEADFAST_UNAUTHORIZED UINT32_C(404)
/* Not allowed in this life-cycle state, or not connected. */
#define STEADFAST_PRECONDITION_NOT_MET UINT32_C(405)
/* A queue, a table or the memory is full. */
#define STEADFAST_OUT_OF_RESOURCES UINT32_C(408)
/* The callee failed. */
#define STEADFAST_CALLEE_ERROR UINT32_C(500)
/* The callee does not offer this. */
#define STEADFAST_UNSUPPORTED_METHOD UINT32_C(501)
/* The callee failed for a reason of its own. */
#define STEADFAST_INTERNAL_FAULT UINT32_C(502)
/* The callee did not answer in time. */
#define STEADFAST_TIMED_OUT UINT32_C(504)
/* The two sides were built for different versions. */
#define STEADFAST_VERSION_MISMATCH UINT32_C(505)
/* Family of failures that a component declares unrecoverable. */
#define STEADFAST_UNRECOVERABLE UINT32_C(0x10000000)
/* The callback panicked (Rust); the text has been handed to the host. */
#define STEADFAST_PANICKED UINT32_C(0x10000200)
/* Family of failures that a component declares recoverable. */
#define STEADFAST_RECOVERABLE UINT32_C(0x20000000)

/* ---- Text ------------------------------------------------------------------------------------ */

/* Borrowed UTF-8 text, not terminated. Null with length 0 is the empty text. */
typedef struct steadfast_text {
    /* First byte; may be null only if `length` is 0. */
    const uint8_t *data;
    /* Length in bytes. */
    size_t length;
} steadfast_text;

/* A text in an initializer, from a string literal. */
#define STEADFAST_TEXT(literal) {(const uint8_t *)("" literal), sizeof("" literal) - 1}

/* A text in an expression, from a terminated string that outlives the call. */
static inline steadfast_text steadfast_text_of(const char *string) {
    steadfast_text text;
    text.data = (const uint8_t *)string;
    text.length = strlen(string);
    return text;
}

/* ---- What the component may ask of the container --------------------------------------------- */

/* Start of every table: who made it, for which version, and how long it is. */
typedef struct steadfast_header {
    /* STEADFAST_ABI_MAGIC. */
    uint64_t magic;
    /* STEADFAST_ABI_MAJOR of the maker. */
    uint32_t major;
    /* STEADFAST_ABI_MINOR of the maker. */
    uint32_t minor;
    /* Size of the whole table in bytes. */
    uint64_t size;
    /* STEADFAST_LAYOUT_HASH of the maker. */
    uint64_t layout_hash;
} steadfast_header;

/* Names one component instance in host calls; its inside belongs to the container. */
typedef struct steadfast_host_context steadfast_host_context;

/* How important a log line is. */
#define STEADFAST_LOG_ERROR UINT32_C(1)
#define STEADFAST_LOG_WARNING UINT32_C(2)
#define STEADFAST_LOG_INFORMATION UINT32_C(3)
#define STEADFAST_LOG_DEBUG UINT32_C(4)

/* Host services. Each may be called only from inside a callback, on the thread and stack that the
 * callback was called on; from anywhere else it answers UNAUTHORIZED. */
typedef struct steadfast_host_table {
    /* Version and size of this table. */
    steadfast_header header;
    /* Copies the next datum of data input `port` into `data` (`size` bytes, the size of its type):
     * SUCCESS for a new datum, NOTHING if there is none since the last read. */
    steadfast_status (*read)(steadfast_host_context *, uint32_t port, uint8_t *data, size_t size);
    /* Sends a datum through data output `port`. Success also when nothing is connected. */
    steadfast_status (*write)(steadfast_host_context *, uint32_t port, const uint8_t *data,
                              size_t size);
    /* Sends an event through event output `port`; OUT_OF_RESOURCES if a receiver's queue is
     * full. */
    steadfast_status (*raise)(steadfast_host_context *, uint32_t port, const uint8_t *data,
                              size_t size);
    /* Calls `method` of required service `port`. A nonblocking method returns at once and has no
     * reply; a blocking one waits at most `deadline_ns` (0: the container's default). */
    steadfast_status (*call)(steadfast_host_context *, uint32_t port, uint32_t method,
                             const uint8_t *request, size_t request_size, uint8_t *reply,
                             size_t reply_size, uint64_t deadline_ns);
    /* Copies the property `name` into `value` (at most `capacity` bytes, not terminated) and stores
     * its full length in bytes; NOTHING if it is not set, OUT_OF_RESOURCES if `capacity` was too
     * small. */
    steadfast_status (*property)(steadfast_host_context *, steadfast_text name, uint8_t *value,
                                 size_t capacity, size_t *length);
    /* Time of the container's clock in nanoseconds since the application started; 0 outside a
     * callback. Simulated time when the container runs simulated. */
    uint64_t (*now_ns)(steadfast_host_context *);
    /* Writes a log line; `level` is one of STEADFAST_LOG_*. */
    steadfast_status (*log)(steadfast_host_context *, uint32_t level, steadfast_text message);
    /* Registers the consecutive memory that holds the component's state. It must stay valid until
     * the instance is destroyed. One region an instance; length 0 withdraws it. */
    steadfast_status (*critical)(steadfast_host_context *, uint8_t *address, size_t length);
    /* Reports a fault that the component has found itself. */
    steadfast_status (*report_fault)(steadfast_host_context *, steadfast_status code,
                                     steadfast_text message);
    /* Says why this callback is about to return a failure: text and, where known, place in the
     * component's source (empty file and line 0 otherwise). */
    steadfast_status (*failed)(steadfast_host_context *, steadfast_text message,
                               steadfast_text file, uint32_t line, uint32_t column);
    /* Opens a device: a name of the simulated world (`simulated:motion_board`) or a path
     * (`/dev/ttyUSB0`, a terminal is set to raw 115200 8N1). Non-blocking; the descriptor belongs
     * to the component. */
    steadfast_status (*open_device)(steadfast_host_context *, steadfast_text name,
                                    int32_t *descriptor);
} steadfast_host_table;

/* ---- What the container calls ---------------------------------------------------------------- */

/* A component instance; its inside belongs to the library. */
typedef struct steadfast_instance steadfast_instance;

/* A callback without arguments. */
typedef steadfast_status (*steadfast_callback)(steadfast_instance *);

/* The callbacks of a component. A null callback succeeds without doing anything; `create` and
 * `destroy_instance` must be there. None may unwind or longjmp out. Callbacks of one instance never
 * run at the same time. */
typedef struct steadfast_callbacks {
    /* Makes an instance; null means it could not. The host table and the context stay valid for as
     * long as the instance lives; the context names this instance in every host call. */
    steadfast_instance *(*create)(const steadfast_host_table *host,
                                  steadfast_host_context *context);
    /* Frees an instance. Never called for one that trapped. */
    void (*destroy_instance)(steadfast_instance *);
    /* onInitialize: CREATED -> READY. */
    steadfast_callback on_initialize;
    /* onStart: READY or INACTIVE -> ACTIVE. */
    steadfast_callback on_start;
    /* onStop: ACTIVE -> INACTIVE. */
    steadfast_callback on_stop;
    /* onReset. */
    steadfast_callback on_reset;
    /* onError: called once when the instance goes to ERROR and can still be called. */
    steadfast_callback on_error;
    /* onRecover: ERROR -> READY; registered memory has been restored. */
    steadfast_callback on_recover;
    /* onDestroy, before `destroy_instance`. */
    steadfast_callback on_destroy;
    /* onExecute: once a cycle. */
    steadfast_callback on_execute;
    /* onUpdated: once a cycle, after every component of the executor has executed. */
    steadfast_callback on_updated;
    /* onEvent: an event arrived at input `port`; `data` holds `size` bytes of its type. */
    steadfast_status (*on_event)(steadfast_instance *, uint32_t port, const uint8_t *data,
                                 size_t size);
    /* onPeriodChanged: the period in nanoseconds; 0 for components without one. Called once before
     * onInitialize and at every change. */
    steadfast_status (*on_period_changed)(steadfast_instance *, uint64_t period_ns);
    /* A method of the provided service `port` was called. `request` holds `request_size` bytes; the
     * answer of `reply_size` bytes is written to `reply`. */
    steadfast_status (*on_call)(steadfast_instance *, uint32_t port, uint32_t method,
                                const uint8_t *request, size_t request_size, uint8_t *reply,
                                size_t reply_size);
} steadfast_callbacks;

/* ---- What a library says of itself ----------------------------------------------------------- */

/* What a field holds: a nested structure (see `nested`), or a number. */
#define STEADFAST_SCALAR_STRUCTURE UINT32_C(0)
#define STEADFAST_SCALAR_U8 UINT32_C(1)
#define STEADFAST_SCALAR_U16 UINT32_C(2)
#define STEADFAST_SCALAR_U32 UINT32_C(3)
#define STEADFAST_SCALAR_U64 UINT32_C(4)
#define STEADFAST_SCALAR_I8 UINT32_C(5)
#define STEADFAST_SCALAR_I16 UINT32_C(6)
#define STEADFAST_SCALAR_I32 UINT32_C(7)
#define STEADFAST_SCALAR_I64 UINT32_C(8)
#define STEADFAST_SCALAR_F32 UINT32_C(9)
#define STEADFAST_SCALAR_F64 UINT32_C(10)

struct steadfast_type;

/* One field of a type. */
typedef struct steadfast_field {
    /* Name of the field. */
    steadfast_text name;
    /* Physical unit ("m", "rad/s"); empty for none. */
    steadfast_text unit;
    /* Offset in bytes from the start of the structure. */
    size_t offset;
    /* One of STEADFAST_SCALAR_*. */
    uint32_t kind;
    /* 0. */
    uint32_t reserved;
    /* Number of consecutive elements, 1 for a single value. */
    size_t count;
    /* Type of a nested structure; null for scalars. */
    const struct steadfast_type *nested;
} steadfast_field;

/* The type of a datum: plain data of fixed size in which every bit pattern is valid. */
typedef struct steadfast_type {
    /* Name of the type. */
    steadfast_text name;
    /* Size in bytes. */
    size_t size;
    /* Alignment in bytes. */
    size_t alignment;
    /* Hash of name, size and all fields; two ports connect only if it agrees. 0: not given (plain
     * C), then name and size must agree. */
    uint64_t layout_hash;
    /* Fields in order of their offset. */
    const steadfast_field *fields;
    /* Number of fields. */
    size_t field_count;
} steadfast_type;

/* One method of a service. */
typedef struct steadfast_method {
    /* Name; required and provided methods are matched by it. */
    steadfast_text name;
    /* 1 if the caller waits for the reply, 0 if the call is queued. */
    uint32_t blocking;
    /* 0. */
    uint32_t reserved;
    /* Type of the request; null for none. */
    const steadfast_type *request;
    /* Type of the reply; null for none. */
    const steadfast_type *reply;
} steadfast_method;

/* Kinds of port. */
#define STEADFAST_PORT_DATA UINT32_C(0)
#define STEADFAST_PORT_EVENT UINT32_C(1)
#define STEADFAST_PORT_SERVICE UINT32_C(2)
/* Directions of ports: `provided` services are inputs, `required` ones outputs. */
#define STEADFAST_PORT_INPUT UINT32_C(0)
#define STEADFAST_PORT_OUTPUT UINT32_C(1)

/* One port; its index in the table is its name in every call. */
typedef struct steadfast_port {
    /* Name, unique in the component. */
    steadfast_text name;
    /* One of STEADFAST_PORT_DATA, _EVENT, _SERVICE. */
    uint32_t kind;
    /* One of STEADFAST_PORT_INPUT, _OUTPUT. */
    uint32_t direction;
    /* Type of the datum or event content; null for services and for events without content. */
    const steadfast_type *data_type;
    /* Methods of a service port. */
    const steadfast_method *methods;
    /* Number of methods. */
    size_t method_count;
} steadfast_port;

/* What a component library exports as `steadfast_component`. */
typedef struct steadfast_library_descriptor {
    /* Version and size of this table. */
    steadfast_header header;
    /* Name of the component type. */
    steadfast_text name;
    /* Version of the component, free text. */
    steadfast_text version;
    /* First of `port_count` ports. */
    const steadfast_port *ports;
    /* Number of ports. */
    size_t port_count;
    /* The callbacks. */
    steadfast_callbacks callbacks;
} steadfast_library_descriptor;

/* The sizes of all tables of this major version, mixed: differs where compilers, pointer widths or
 * forked headers disagree although the version number agrees. */
#define STEADFAST_MIX(hash, type) ((hash) * UINT64_C(1000003) + (uint64_t)sizeof(type))
#define STEADFAST_LAYOUT_HASH                                                                      \
    STEADFAST_MIX(                                                                                 \
        STEADFAST_MIX(                                                                             \
            STEADFAST_MIX(                                                                         \
                STEADFAST_MIX(                                                                     \
                    STEADFAST_MIX(STEADFAST_MIX(STEADFAST_MIX((uint64_t)sizeof(size_t),            \
                                                              steadfast_header),                   \
                                                steadfast_text),                                   \
                                  steadfast_callbacks),                                            \
                    steadfast_port),                                                               \
                steadfast_method),                                                                 \
            steadfast_type),                                                                       \
        steadfast_field)

/* ---- Conveniences for initializers (C only) --------------------------------------------------- */

/* The header of a table of this type. */
#define STEADFAST_HEADER(table)                                                                    \
    {STEADFAST_ABI_MAGIC, STEADFAST_ABI_MAJOR, STEADFAST_ABI_MINOR, (uint64_t)sizeof(table),       \
     STEADFAST_LAYOUT_HASH}

/* Number of elements of an array. */
#define STEADFAST_COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* A number in a structure; `scalar` is what follows STEADFAST_SCALAR_. */
#define STEADFAST_FIELD(structure, member, scalar, unit)                                           \
    {STEADFAST_TEXT(#member), STEADFAST_TEXT(unit), offsetof(structure, member),                   \
     STEADFAST_SCALAR_##scalar, 0, 1, NULL}

/* A type with an array of fields. */
#define STEADFAST_TYPE(name, structure, fields)                                                    \
    {STEADFAST_TEXT(name), sizeof(structure), _Alignof(structure), 0, fields,                      \
     STEADFAST_COUNT(fields)}

#define STEADFAST_DATA_INPUT(name, type)                                                           \
    {STEADFAST_TEXT(name), STEADFAST_PORT_DATA, STEADFAST_PORT_INPUT, type, NULL, 0}
#define STEADFAST_DATA_OUTPUT(name, type)                                                          \
    {STEADFAST_TEXT(name), STEADFAST_PORT_DATA, STEADFAST_PORT_OUTPUT, type, NULL, 0}
#define STEADFAST_EVENT_INPUT(name, type)                                                          \
    {STEADFAST_TEXT(name), STEADFAST_PORT_EVENT, STEADFAST_PORT_INPUT, type, NULL, 0}
#define STEADFAST_EVENT_OUTPUT(name, type)                                                         \
    {STEADFAST_TEXT(name), STEADFAST_PORT_EVENT, STEADFAST_PORT_OUTPUT, type, NULL, 0}

#if defined(__GNUC__)
#define STEADFAST_EXPORT __attribute__((visibility("default")))
#else
#define STEADFAST_EXPORT
#endif

/* Exports a component with an array of ports; the callbacks follow as designated initializers. */
#define STEADFAST_COMPONENT(name, version, ports, ...)                                             \
    extern STEADFAST_EXPORT const steadfast_library_descriptor steadfast_component;                \
    const steadfast_library_descriptor steadfast_component = {                                     \
        STEADFAST_HEADER(steadfast_library_descriptor),                                            \
        STEADFAST_TEXT(name),                                                                      \
        STEADFAST_TEXT(version),                                                                   \
        ports,                                                                                     \
        STEADFAST_COUNT(ports),                                                                    \
        {__VA_ARGS__}};

#ifdef __cplusplus
}
#endif

#endif
