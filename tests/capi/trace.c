/*
 * A C program with a Vulkan device of its own: it builds grids over meshes that it makes, traces rays through them with gridwalk, and
 * compares with every ray against every triangle, in double precision, here. C11, and C++17 too.
 *
 *     trace            exit status 0 if all agrees, 1 if something does not, 2 if there is no device to try it on
 *     trace --wrong    expects what is not so: must end with 1
 *
 * GRIDWALK_VALIDATE=0 runs without the validation layer; it is also left out, aloud, where it is not installed.
 */
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gridwalk.h"

enum { ACROSS = 24, AROUND = 48, VERTICES = ACROSS * AROUND, TRIANGLES = 2 * VERTICES, RAYS = 5000, FEWER_RAYS = 3333, MAX_STEPS = 256, NEAREST = 4 };

/* Setting a structure to zero works for C and C++ alike, whatever its first field is. */
#define ZERO(object) memset(&(object), 0, sizeof(object))

static void fail(const char *what) {
    fprintf(stderr, "FAILED: %s\n", what);
    exit(1);
}

static void check_vk(VkResult result, const char *what) {
    if (result != VK_SUCCESS) {
        fprintf(stderr, "%s: VkResult %d\n", what, (int)result);
        exit(1);
    }
}

static void check(GridwalkResult result, const char *what) {
    if (result != GRIDWALK_RESULT_OK) {
        fprintf(stderr, "%s: %d: %s\n", what, (int)result, gridwalk_last_error());
        exit(1);
    }
}

/* A call that must fail so, and whose message must hold this. */
static void refused(GridwalkResult result, GridwalkResult expected, const char *words) {
    if (result != expected || !strstr(gridwalk_last_error(), words)) {
        fprintf(stderr, "FAILED: result %d with \"%s\", where %d with \"%s\" was expected\n", (int)result, gridwalk_last_error(),
                (int)expected, words);
        exit(1);
    }
}

/* Vulkan. */

#define INSTANCE_FUNCTIONS(X) \
    X(vkDestroyInstance) X(vkEnumeratePhysicalDevices) X(vkGetPhysicalDeviceProperties) X(vkGetPhysicalDeviceQueueFamilyProperties) \
    X(vkGetPhysicalDeviceMemoryProperties) X(vkCreateDevice) X(vkGetDeviceProcAddr)
#define DEVICE_FUNCTIONS(X) \
    X(vkDestroyDevice) X(vkGetDeviceQueue) X(vkCreateBuffer) X(vkDestroyBuffer) X(vkGetBufferMemoryRequirements) X(vkAllocateMemory) \
    X(vkFreeMemory) X(vkBindBufferMemory) X(vkMapMemory) X(vkGetBufferDeviceAddress) X(vkCreateCommandPool) X(vkDestroyCommandPool) \
    X(vkAllocateCommandBuffers) X(vkBeginCommandBuffer) X(vkEndCommandBuffer) X(vkQueueSubmit) X(vkQueueWaitIdle) X(vkCreateQueryPool) \
    X(vkDestroyQueryPool) X(vkGetQueryPoolResults) X(vkCreatePipelineCache) X(vkDestroyPipelineCache)

static PFN_vkGetInstanceProcAddr get_instance_proc_addr;
#define DECLARE(name) static PFN_##name name##_;
INSTANCE_FUNCTIONS(DECLARE)
DEVICE_FUNCTIONS(DECLARE)

static VkInstance instance;
static VkDebugUtilsMessengerEXT messenger;
static int validated, messages;
static VkPhysicalDevice physical_device;
static VkPhysicalDeviceMemoryProperties memory_properties;
static uint32_t queue_family, timestamp_bits;
static VkDevice device;
static VkQueue queue;

static VKAPI_ATTR VkBool32 VKAPI_CALL heard(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT type,
                                            const VkDebugUtilsMessengerCallbackDataEXT *data, void *user) {
    (void)severity, (void)type, (void)user;
    fprintf(stderr, "validation: %s\n", data->pMessage);
    ++messages;
    return VK_FALSE;
}

static int has_validation(void) {
    const char *variable = getenv("GRIDWALK_VALIDATE");
    if (variable && !strcmp(variable, "0")) return 0;
    PFN_vkEnumerateInstanceLayerProperties enumerate =
        (PFN_vkEnumerateInstanceLayerProperties)get_instance_proc_addr(NULL, "vkEnumerateInstanceLayerProperties");
    VkLayerProperties layers[64];
    uint32_t count = 64;
    if (enumerate(&count, layers) < 0) return 0;
    for (uint32_t i = 0; i < count; ++i)
        if (!strcmp(layers[i].layerName, "VK_LAYER_KHRONOS_validation")) return 1;
    fprintf(stderr, "SKIPPED: the validation layer is not installed (apt-get install vulkan-validationlayers)\n");
    return 0;
}

static void make_instance(void) {
    void *library = dlopen("libvulkan.so.1", RTLD_NOW);
    void *symbol = library ? dlsym(library, "vkGetInstanceProcAddr") : NULL;
    if (!symbol) {
        fprintf(stderr, "no Vulkan loader here: %s\n", dlerror());
        exit(2);
    }
    /* C has no cast from an object to a function. */
    memcpy(&get_instance_proc_addr, &symbol, sizeof symbol);
    PFN_vkCreateInstance create = (PFN_vkCreateInstance)get_instance_proc_addr(NULL, "vkCreateInstance");

    VkApplicationInfo application;
    ZERO(application);
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.apiVersion = VK_API_VERSION_1_3;
    VkDebugUtilsMessengerCreateInfoEXT listen;
    ZERO(listen);
    listen.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    listen.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT;
    listen.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    listen.pfnUserCallback = heard;
    VkValidationFeatureEnableEXT enable = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT validation;
    ZERO(validation);
    validation.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
    validation.pNext = &listen;
    validation.enabledValidationFeatureCount = 1;
    validation.pEnabledValidationFeatures = &enable;
    const char *layers[] = {"VK_LAYER_KHRONOS_validation"};
    const char *extensions[] = {"VK_EXT_debug_utils", "VK_EXT_validation_features"};
    VkInstanceCreateInfo info;
    ZERO(info);
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pApplicationInfo = &application;
    validated = has_validation();
    if (validated) {
        info.pNext = &validation;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = layers;
        info.enabledExtensionCount = 2;
        info.ppEnabledExtensionNames = extensions;
    }
    check_vk(create(&info, NULL, &instance), "vkCreateInstance");
#define LOAD_INSTANCE(name) name##_ = (PFN_##name)get_instance_proc_addr(instance, #name);
    INSTANCE_FUNCTIONS(LOAD_INSTANCE)
    if (validated) {
        PFN_vkCreateDebugUtilsMessengerEXT messenger_create =
            (PFN_vkCreateDebugUtilsMessengerEXT)get_instance_proc_addr(instance, "vkCreateDebugUtilsMessengerEXT");
        check_vk(messenger_create(instance, &listen, NULL, &messenger), "vkCreateDebugUtilsMessengerEXT");
    }
}

static int find_queue_family(void) {
    VkQueueFamilyProperties families[16];
    uint32_t count = 16;
    vkGetPhysicalDeviceQueueFamilyProperties_(physical_device, &count, families);
    for (queue_family = 0; queue_family < count; ++queue_family) {
        timestamp_bits = families[queue_family].timestampValidBits;
        if (families[queue_family].queueFlags & VK_QUEUE_COMPUTE_BIT) return 1;
    }
    return 0;
}

/* The first device that can serve. */
static void make_device(void) {
    VkPhysicalDevice all[16];
    uint32_t count = 16;
    if (vkEnumeratePhysicalDevices_(instance, &count, all) < 0) count = 0;
    VkPhysicalDeviceVulkan12Features features_12;
    VkPhysicalDeviceVulkan13Features features_13;
    ZERO(features_12);
    ZERO(features_13);
    features_12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    features_12.pNext = &features_13;
    features_12.hostQueryReset = VK_FALSE;
    features_13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
    for (uint32_t i = 0; i < count && !physical_device; ++i) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties_(all[i], &properties);
        GridwalkResult result = gridwalk_requirements(get_instance_proc_addr, instance, all[i], &features_12);
        fprintf(stderr, "%s: %s\n", properties.deviceName, result == GRIDWALK_RESULT_OK ? "can serve" : gridwalk_last_error());
        if (result == GRIDWALK_RESULT_OK) physical_device = all[i];
    }
    if (!physical_device || !find_queue_family()) {
        fprintf(stderr, "no device can serve\n");
        exit(2);
    }
    if (!features_12.bufferDeviceAddress || !features_13.synchronization2 || features_12.descriptorIndexing || features_13.maintenance4)
        fail("gridwalk_requirements enables what it needs, and nothing else");
    refused(gridwalk_requirements(get_instance_proc_addr, instance, physical_device, &features_13), GRIDWALK_RESULT_ERROR_STRUCT,
            "VkPhysicalDeviceVulkan12Features");
    refused(gridwalk_requirements(NULL, instance, physical_device, NULL), GRIDWALK_RESULT_ERROR_NULL, "get_instance_proc_addr");
    refused(gridwalk_requirements(get_instance_proc_addr, NULL, physical_device, NULL), GRIDWALK_RESULT_ERROR_NULL, "instance");
    refused(gridwalk_requirements(get_instance_proc_addr, instance, NULL, NULL), GRIDWALK_RESULT_ERROR_NULL, "physical_device");

    float priority = 1;
    VkDeviceQueueCreateInfo queues;
    ZERO(queues);
    queues.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queues.queueFamilyIndex = queue_family;
    queues.queueCount = 1;
    queues.pQueuePriorities = &priority;
    VkDeviceCreateInfo info;
    ZERO(info);
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = &features_12;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queues;
    check_vk(vkCreateDevice_(physical_device, &info, NULL, &device), "vkCreateDevice");
#define LOAD_DEVICE(name) name##_ = (PFN_##name)vkGetDeviceProcAddr_(device, #name);
    DEVICE_FUNCTIONS(LOAD_DEVICE)
    vkGetDeviceQueue_(device, queue_family, 0, &queue);
    vkGetPhysicalDeviceMemoryProperties_(physical_device, &memory_properties);
}

/* A buffer that the host writes and reads as well: simple, not fast. */
typedef struct Memory {
    VkDeviceMemory memory;
    GridwalkRegion region;
    void *data;
} Memory;

static Memory memories[32];
static int memory_count;

static Memory *make_memory(VkDeviceSize size, VkBufferUsageFlags usage) {
    if (memory_count == sizeof memories / sizeof *memories) fail("room for another buffer");
    Memory *made = &memories[memory_count++];
    VkBufferCreateInfo info;
    ZERO(info);
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = made->region.size = size;
    info.usage = usage | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    check_vk(vkCreateBuffer_(device, &info, NULL, &made->region.buffer), "vkCreateBuffer");
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements_(device, made->region.buffer, &needs);
    VkMemoryAllocateFlagsInfo flags;
    ZERO(flags);
    flags.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO;
    flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
    VkMemoryAllocateInfo allocate;
    ZERO(allocate);
    allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    allocate.pNext = &flags;
    allocate.allocationSize = needs.size;
    const VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    while (!(needs.memoryTypeBits >> allocate.memoryTypeIndex & 1) ||
           (memory_properties.memoryTypes[allocate.memoryTypeIndex].propertyFlags & wanted) != wanted)
        ++allocate.memoryTypeIndex;
    check_vk(vkAllocateMemory_(device, &allocate, NULL, &made->memory), "vkAllocateMemory");
    check_vk(vkBindBufferMemory_(device, made->region.buffer, made->memory, 0), "vkBindBufferMemory");
    check_vk(vkMapMemory_(device, made->memory, 0, VK_WHOLE_SIZE, 0, &made->data), "vkMapMemory");
    VkBufferDeviceAddressInfo address;
    ZERO(address);
    address.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO;
    address.buffer = made->region.buffer;
    made->region.address = vkGetBufferDeviceAddress_(device, &address);
    memset(made->data, 0xAB, (size_t)size);
    return made;
}

static Memory *make_region(GridwalkRegionSize size) {
    Memory *made = make_memory(size.size, size.usage);
    if (made->region.address % size.alignment) fail("a buffer of its own is aligned");
    return made;
}

/* Meshes and rays. */

typedef struct Mesh {
    /* On the device, and as the CPU reads them. */
    Memory *positions, *indices;
    float *corners;
    uint32_t *triangles;
    uint32_t vertex_count, triangle_count;
} Mesh;

static Mesh make_mesh(uint32_t vertex_count, uint32_t triangle_count) {
    Mesh mesh = {make_memory(vertex_count * 12, 0), make_memory(triangle_count * 12, 0), NULL, NULL, vertex_count, triangle_count};
    mesh.corners = (float *)mesh.positions->data;
    mesh.triangles = (uint32_t *)mesh.indices->data;
    return mesh;
}

static uint32_t seed = 2463534242u;

/* Marsaglia's xorshift: the same numbers everywhere. In [0, 1). */
static float random_float(void) {
    seed ^= seed << 13;
    seed ^= seed >> 17;
    seed ^= seed << 5;
    return (float)(seed >> 8) / 16777216.0f;
}

/* A torus with waves on it, at a time. */
static void place_torus(float *positions, float time) {
    const float tau = 6.2831853f;
    for (int i = 0; i < ACROSS; ++i)
        for (int j = 0; j < AROUND; ++j) {
            float a = tau * (float)i / ACROSS, b = tau * (float)j / AROUND;
            float radius = 0.4f + 0.1f * sinf(5 * b + time), ring = 1 + radius * cosf(a);
            float *p = positions + 3 * (i * AROUND + j);
            p[0] = ring * cosf(b), p[1] = radius * sinf(a), p[2] = ring * sinf(b);
        }
}

static Mesh make_torus(void) {
    Mesh mesh = make_mesh(VERTICES, TRIANGLES);
    uint32_t *index = mesh.triangles;
    for (uint32_t i = 0; i < ACROSS; ++i)
        for (uint32_t j = 0; j < AROUND; ++j) {
            uint32_t k = (i + 1) % ACROSS, l = (j + 1) % AROUND;
            uint32_t a = i * AROUND + j, b = k * AROUND + j, c = k * AROUND + l, d = i * AROUND + l;
            const uint32_t corners[6] = {a, b, c, a, c, d};
            memcpy(index, corners, sizeof corners);
            index += 6;
        }
    return mesh;
}

/* A floor of two triangles, a third with a vertex that is not finite, and a fourth with an index beyond the vertices. */
static Mesh make_floor(void) {
    static const float positions[5][3] = {{-2, -0.3f, -2}, {2, -0.3f, -2}, {2, -0.3f, 2}, {-2, -0.3f, 2}, {0, HUGE_VALF, 0}};
    static const uint32_t indices[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 1, 4}, {0, 1, 5}};
    Mesh mesh = make_mesh(5, 4);
    memcpy(mesh.corners, positions, sizeof positions);
    memcpy(mesh.triangles, indices, sizeof indices);
    return mesh;
}

static void make_rays(GridwalkRay *rays) {
    for (int i = 0; i < RAYS; ++i) {
        GridwalkRay *ray = &rays[i];
        for (int axis = 0; axis < 3; ++axis) {
            ray->origin[axis] = 6 * random_float() - 3;
            ray->direction[axis] = 3 * random_float() - 1.5f - ray->origin[axis];
        }
        /* Some along an axis, some short, some that begin late. */
        if (i % 16 == 1) ray->direction[i / 16 % 3] = 0, ray->direction[(i / 16 + 1) % 3] = -0.0f;
        ray->t_min = i % 5 == 2 ? 0.8f : 0;
        ray->t_max = i % 7 == 3 ? 1.1f : HUGE_VALF;
    }
    rays[10].direction[1] = NAN;
}

/* What a mesh does to a ray, in double precision. */

typedef struct Bounds {
    /* Nearest distance of a hit that is beyond doubt, and of one that may be one, being so near to an edge or to an end of the ray. */
    double sure, possible;
    /* Fewest and most hits. */
    uint32_t fewest, most;
} Bounds;

static void cross(const double a[3], const double b[3], double c[3]) {
    for (int i = 0; i < 3; ++i) c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static const double slack = 1e-5;
/* What the program is wrong by on purpose. */
static double shift;

/* Möller and Trumbore 1997. Returns 0 where there is no distance. */
static int meet(const Mesh *mesh, uint32_t triangle, const GridwalkRay *ray, double *t, double *u, double *v) {
    const uint32_t *index = mesh->triangles + 3 * triangle;
    double corner[3][3], edge_1[3], edge_2[3], from[3], direction[3], p[3], q[3];
    for (int i = 0; i < 3; ++i) {
        if (index[i] >= mesh->vertex_count) return 0;
        for (int axis = 0; axis < 3; ++axis) {
            corner[i][axis] = mesh->corners[3 * index[i] + (uint32_t)axis] + shift;
            if (!isfinite(corner[i][axis])) return 0;
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        edge_1[axis] = corner[1][axis] - corner[0][axis];
        edge_2[axis] = corner[2][axis] - corner[0][axis];
        from[axis] = ray->origin[axis] - corner[0][axis];
        direction[axis] = ray->direction[axis];
    }
    cross(direction, edge_2, p);
    double determinant = dot(edge_1, p);
    if (!(fabs(determinant) > 0)) return 0;
    cross(from, edge_1, q);
    *u = dot(from, p) / determinant;
    *v = dot(direction, q) / determinant;
    *t = dot(edge_2, q) / determinant;
    return 1;
}

static void brute_force(const Mesh *mesh, const GridwalkRay *ray, Bounds *bounds) {
    for (uint32_t i = 0; i < mesh->triangle_count; ++i) {
        double t, u, v;
        if (!meet(mesh, i, ray, &t, &u, &v)) continue;
        if (u < -slack || v < -slack || u + v > 1 + slack || t < ray->t_min - slack || t > ray->t_max + slack) continue;
        ++bounds->most;
        if (t < bounds->possible) bounds->possible = t;
        if (u < slack || v < slack || u + v > 1 - slack || t < ray->t_min + slack || t > ray->t_max - slack) continue;
        ++bounds->fewest;
        if (t < bounds->sure) bounds->sure = t;
    }
}

static int wrong;

static void differs(const char *what, int i, double found, const Bounds *bounds) {
    if (wrong++ < 5) fprintf(stderr, "ray %d: %s: found %.9g, expected %.9g to %.9g\n", i, what, found, bounds->possible, bounds->sure);
}

/* Whether a hit's triangle is where the hit says. */
static int consistent(const Mesh *mesh, const GridwalkRay *ray, const GridwalkHit *hit) {
    double t, u, v;
    return hit->triangle < mesh->triangle_count && meet(mesh, hit->triangle, ray, &t, &u, &v) && fabs(t - hit->t) <= 1e-4 * (1 + t) &&
           fabs(u - hit->u) <= 1e-3 && fabs(v - hit->v) <= 1e-3;
}

static void same_report(const GridwalkReport *report, uint32_t triangles, uint32_t dropped) {
    if (report->triangles != triangles || report->dropped != dropped || report->overflow || !report->pairs || report->triangle_total != triangles) {
        fprintf(stderr, "report: %u triangles, %u dropped, overflow %u, %u pairs\n", report->triangles, report->dropped, report->overflow,
                report->pairs);
        fail("the report tells of the build");
    }
}

static VkCommandPool command_pool;

static void make_commands(void) {
    VkCommandPoolCreateInfo info;
    ZERO(info);
    info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    info.queueFamilyIndex = queue_family;
    check_vk(vkCreateCommandPool_(device, &info, NULL, &command_pool), "vkCreateCommandPool");
}

static VkCommandBuffer begin_commands(void) {
    VkCommandBufferAllocateInfo allocate;
    ZERO(allocate);
    allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate.commandPool = command_pool;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    VkCommandBuffer cmd;
    check_vk(vkAllocateCommandBuffers_(device, &allocate, &cmd), "vkAllocateCommandBuffers");
    VkCommandBufferBeginInfo begin;
    ZERO(begin);
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    check_vk(vkBeginCommandBuffer_(cmd, &begin), "vkBeginCommandBuffer");
    return cmd;
}

static void submit_and_wait(VkCommandBuffer cmd) {
    VkSubmitInfo submit;
    ZERO(submit);
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &cmd;
    VkFence no_fence;
    ZERO(no_fence);
    check_vk(vkQueueSubmit_(queue, 1, &submit, no_fence), "vkQueueSubmit");
    check_vk(vkQueueWaitIdle_(queue), "vkQueueWaitIdle");
}

/* Behind a build or a trace, before the next one, and before the host reads. An engine would name what it needs. */
static void barrier(const GridwalkTracer *tracer, VkCommandBuffer cmd) {
    check(gridwalk_cmd_barrier(tracer, cmd, GRIDWALK_BUILD_STAGES | GRIDWALK_TRACE_STAGES, GRIDWALK_BUILD_ACCESS | GRIDWALK_TRACE_ACCESS,
                               GRIDWALK_BUILD_STAGES | GRIDWALK_TRACE_STAGES | GRIDWALK_HOST_READ_STAGES,
                               GRIDWALK_BUILD_ACCESS | GRIDWALK_TRACE_ACCESS | GRIDWALK_HOST_READ_ACCESS),
          "gridwalk_cmd_barrier");
}

static GridwalkBuildInfo build_info(const Mesh *mesh, const Memory *grid, const Memory *scratch, const Memory *report,
                                    GridwalkCapacity capacity) {
    GridwalkBuildInfo build;
    ZERO(build);
    build.struct_size = sizeof build;
    build.geometry.positions = mesh->positions->region;
    build.geometry.vertex_count = mesh->vertex_count;
    build.geometry.indices = mesh->indices->region;
    build.geometry.triangle_count = mesh->triangle_count;
    build.grid = grid->region;
    build.scratch = scratch->region;
    build.report = report->region;
    build.capacity = capacity;
    return build;
}

static GridwalkTraceInfo trace_info(const Memory *rays, const Memory *hits, const Memory *scratch, uint32_t count) {
    GridwalkTraceInfo trace;
    ZERO(trace);
    trace.struct_size = sizeof trace;
    trace.ray_count = count;
    trace.rays = rays->region;
    trace.hits = hits->region;
    trace.scratch = scratch->region;
    return trace;
}

/* Nothing that is refused may reach the command buffer: it is compared with the CPU afterwards. */
static void refuse(const GridwalkTracer *tracer, VkCommandBuffer cmd, const GridwalkBuildInfo *build, const GridwalkTraceInfo *trace) {
    GridwalkBuildSizes sizes;
    GridwalkRegionSize size;
    GridwalkCapacity capacity = build->capacity;
    refused(gridwalk_build_sizes(NULL, &capacity, &sizes), GRIDWALK_RESULT_ERROR_NULL, "tracer");
    refused(gridwalk_build_sizes(tracer, NULL, &sizes), GRIDWALK_RESULT_ERROR_NULL, "capacity");
    refused(gridwalk_build_sizes(tracer, &capacity, NULL), GRIDWALK_RESULT_ERROR_NULL, "sizes");
    capacity.cells = GRIDWALK_MAX_CELLS + 1;
    refused(gridwalk_build_sizes(tracer, &capacity, &sizes), GRIDWALK_RESULT_ERROR_CAPACITY, "cells");
    refused(gridwalk_trace_scratch_size(tracer, UINT32_MAX, &size), GRIDWALK_RESULT_ERROR_CAPACITY, "rays");
    refused(gridwalk_cmd_barrier(tracer, NULL, 0, 0, 0, 0), GRIDWALK_RESULT_ERROR_NULL, "command_buffer");
    refused(gridwalk_cmd_build(NULL, cmd, build), GRIDWALK_RESULT_ERROR_NULL, "tracer");
    refused(gridwalk_cmd_build(tracer, cmd, NULL), GRIDWALK_RESULT_ERROR_NULL, "GridwalkBuildInfo");

    GridwalkBuildInfo bad = *build;
    bad.struct_size = 0;
    refused(gridwalk_cmd_build(tracer, cmd, &bad), GRIDWALK_RESULT_ERROR_STRUCT, "struct_size");
    bad = *build;
    bad.grid.size -= 1;
    refused(gridwalk_cmd_build(tracer, cmd, &bad), GRIDWALK_RESULT_ERROR_REGION, "grid");
    bad = *build;
    bad.grid.offset = UINT64_MAX;
    refused(gridwalk_cmd_build(tracer, cmd, &bad), GRIDWALK_RESULT_ERROR_REGION, "beyond");
    bad = *build;
    bad.scratch.address += 4;
    refused(gridwalk_cmd_build(tracer, cmd, &bad), GRIDWALK_RESULT_ERROR_REGION, "scratch");
    bad = *build;
    ZERO(bad.scratch.buffer);
    refused(gridwalk_cmd_build(tracer, cmd, &bad), GRIDWALK_RESULT_ERROR_REGION, "scratch");
    bad = *build;
    bad.geometry.triangle_count = bad.capacity.triangles + 1;
    refused(gridwalk_cmd_build(tracer, cmd, &bad), GRIDWALK_RESULT_ERROR_CAPACITY, "triangles");
    bad = *build;
    bad.density = NAN;
    refused(gridwalk_cmd_build(tracer, cmd, &bad), GRIDWALK_RESULT_ERROR_OPTION, "density");
    bad = *build;
    bad.overlap = 7;
    refused(gridwalk_cmd_build(tracer, cmd, &bad), GRIDWALK_RESULT_ERROR_OPTION, "overlap");
    bad = *build;
    bad.resolution[1] = 4;
    refused(gridwalk_cmd_build(tracer, cmd, &bad), GRIDWALK_RESULT_ERROR_OPTION, "resolution");

    /* A structure of a newer header, whose last field the library cannot know. */
    struct {
        GridwalkTraceInfo known;
        uint64_t unknown;
    } newer;
    ZERO(newer);
    newer.known = *trace;
    newer.known.struct_size = sizeof newer;
    newer.unknown = 1;
    refused(gridwalk_cmd_closest_hit(tracer, cmd, build->grid.address, &newer.known), GRIDWALK_RESULT_ERROR_STRUCT, "newer library");
    GridwalkTraceInfo bad_trace = *trace;
    bad_trace.hits.address += 8;
    refused(gridwalk_cmd_closest_hit(tracer, cmd, build->grid.address, &bad_trace), GRIDWALK_RESULT_ERROR_REGION, "hits");
    refused(gridwalk_cmd_closest_hit(tracer, cmd, 0, trace), GRIDWALK_RESULT_ERROR_REGION, "grid");
    bad_trace = *trace;
    bad_trace.resume = VK_TRUE;
    refused(gridwalk_cmd_any_hit(tracer, cmd, build->grid.address, &bad_trace), GRIDWALK_RESULT_ERROR_OPTION, "resume");
}

/* A tracer cannot be made of everything. */
static void refuse_descriptions(const GridwalkDeviceDesc *desc) {
    GridwalkTracer *tracer = (GridwalkTracer *)&wrong;
    GridwalkDeviceDesc bad = *desc;
    bad.device = NULL;
    refused(gridwalk_tracer_create(&bad, &tracer), GRIDWALK_RESULT_ERROR_NULL, "device");
    if (tracer) fail("a tracer that cannot be made is null");
    bad = *desc;
    bad.get_instance_proc_addr = NULL;
    refused(gridwalk_tracer_create(&bad, &tracer), GRIDWALK_RESULT_ERROR_NULL, "get_instance_proc_addr");
    refused(gridwalk_tracer_create(NULL, &tracer), GRIDWALK_RESULT_ERROR_NULL, "GridwalkDeviceDesc");
    refused(gridwalk_tracer_create(desc, NULL), GRIDWALK_RESULT_ERROR_NULL, "tracer");
    if (!validated) {
        bad = *desc;
        bad.debug_utils = VK_TRUE;
        refused(gridwalk_tracer_create(&bad, &tracer), GRIDWALK_RESULT_ERROR_OPTION, "VK_EXT_debug_utils");
    }
    gridwalk_tracer_destroy(NULL);
}

/* Adds what a record makes of a mesh to another mesh; triangles that a mask does not see get an index out of range. */
static void flatten(Mesh *to, const Mesh *from, const GridwalkGeometryRecord *record, int seen) {
    uint32_t first = to->vertex_count;
    for (uint32_t i = 0; i < from->vertex_count; ++i, ++to->vertex_count)
        for (int axis = 0; axis < 3; ++axis) {
            float sum = record->transform[axis][3];
            for (int k = 0; k < 3; ++k) sum += record->transform[axis][k] * (from->corners[3 * i + (uint32_t)k] * record->scale[k]);
            to->corners[3 * to->vertex_count + (uint32_t)axis] = sum;
        }
    for (uint32_t i = 0; i < 3 * from->triangle_count; ++i) {
        uint32_t index = from->triangles[i];
        to->triangles[3 * to->triangle_count + i] = seen && index < from->vertex_count ? first + index : UINT32_MAX;
    }
    to->triangle_count += from->triangle_count;
}

/* A grid of three records: half of a torus, by a number that the device reads; a smaller torus beside it; a floor. */
static void trace_records(const GridwalkTracer *tracer, const Mesh *torus, const Mesh *ground, const Memory *rays) {
    enum { HALF = TRIANGLES / 2, ALL = HALF + TRIANGLES + 4, TRACES = 5 };
    const uint32_t first[3] = {0, HALF, HALF + TRIANGLES}, ids[3] = {10, 20, 30}, visible[3] = {1, 2, 3};
    Memory *count = make_memory(4, 0), *records = make_memory(3 * sizeof(GridwalkGeometryRecord), 0);
    const uint32_t half = HALF;
    memcpy(count->data, &half, 4);
    GridwalkGeometryRecord *record = (GridwalkGeometryRecord *)records->data;
    refused(gridwalk_geometry_record_init(NULL), GRIDWALK_RESULT_ERROR_NULL, "record");
    for (int i = 0; i < 3; ++i) {
        const Mesh *mesh = i == 2 ? ground : torus;
        check(gridwalk_geometry_record_init(&record[i]), "gridwalk_geometry_record_init");
        record[i].positions = mesh->positions->region.address;
        record[i].indices = mesh->indices->region.address;
        record[i].vertex_count = mesh->vertex_count;
        record[i].triangle_count = mesh->triangle_count;
        record[i].id = ids[i];
        record[i].mask = visible[i];
    }
    record[0].count = count->region.address;
    record[1].scale[0] = record[1].scale[1] = record[1].scale[2] = 0.5f;
    record[1].transform[1][3] = 1;

    GridwalkCapacity capacity = {ALL, 16 * ALL, 16 * ALL, ALL};
    GridwalkBuildSizes sizes;
    GridwalkRegionSize trace_size, sort_size;
    check(gridwalk_build_sizes(tracer, &capacity, &sizes), "gridwalk_build_sizes");
    check(gridwalk_trace_scratch_size(tracer, RAYS, &trace_size), "gridwalk_trace_scratch_size");
    check(gridwalk_ray_sort_scratch_size(tracer, RAYS, &sort_size), "gridwalk_ray_sort_scratch_size");
    Memory *grid = make_region(sizes.grid), *scratch = make_region(sizes.scratch), *report = make_region(sizes.report);
    Memory *sort_scratch = make_region(sort_size), *order = make_memory(RAYS * 4, 0);
    Memory *trace_scratch = make_region(trace_size), *masks = make_memory(RAYS * 4, 0), *geometries = make_memory(RAYS * 8, 0);
    Memory *hits[3], *counts = make_memory(RAYS * 4, 0), *nearest = make_memory(RAYS * NEAREST * sizeof(GridwalkHit), 0);
    for (int i = 0; i < 3; ++i) hits[i] = make_memory(RAYS * sizeof(GridwalkHit), 0);
    for (uint32_t i = 0; i < RAYS; ++i) ((uint32_t *)masks->data)[i] = 1 + i % 2;

    GridwalkBuildInfo build;
    ZERO(build);
    build.struct_size = sizeof build;
    build.records = records->region;
    build.record_count = 3;
    build.grid = grid->region;
    build.scratch = scratch->region;
    build.report = report->region;
    build.capacity = capacity;
    VkCommandBuffer cmd = begin_commands();
    GridwalkBuildInfo bad = build;
    bad.geometry.triangle_count = 1;
    refused(gridwalk_cmd_build(tracer, cmd, &bad), GRIDWALK_RESULT_ERROR_OPTION, "records");
    check(gridwalk_cmd_build(tracer, cmd, &build), "gridwalk_cmd_build");
    barrier(tracer, cmd);
    GridwalkRaySortInfo sort;
    ZERO(sort);
    sort.struct_size = sizeof sort;
    sort.ray_count = RAYS;
    sort.rays = rays->region;
    sort.order = order->region;
    sort.scratch = sort_scratch->region;
    check(gridwalk_cmd_sort_rays(tracer, cmd, grid->region.address, &sort), "gridwalk_cmd_sort_rays");
    sort.order.size -= 4;
    refused(gridwalk_cmd_sort_rays(tracer, cmd, grid->region.address, &sort), GRIDWALK_RESULT_ERROR_REGION, "order");
    barrier(tracer, cmd);
    for (uint32_t i = 0; i < TRACES; ++i) {
        /* The closest hit of both sides, of fronts, of backs; how many; the nearest of them: but for the first in the order of the sort. */
        GridwalkTraceInfo trace = trace_info(rays, i < 3 ? hits[i] : i == 3 ? counts : nearest, trace_scratch, RAYS);
        trace.masks = masks->region;
        if (i == 0) trace.geometries = geometries->region;
        if (i < 3) trace.cull = i;
        if (i > 0) trace.order = order->region;
        GridwalkTraceInfo bad_trace = trace;
        bad_trace.cull = 3;
        refused(gridwalk_cmd_closest_hit(tracer, cmd, grid->region.address, &bad_trace), GRIDWALK_RESULT_ERROR_OPTION, "cull");
        check(i < 3    ? gridwalk_cmd_closest_hit(tracer, cmd, grid->region.address, &trace)
              : i == 3 ? gridwalk_cmd_count_hits(tracer, cmd, grid->region.address, &trace)
                       : gridwalk_cmd_nearest_hits(tracer, cmd, grid->region.address, &trace, NEAREST),
              "a trace of records");
        refused(gridwalk_cmd_nearest_hits(tracer, cmd, grid->region.address, &trace, 0), GRIDWALK_RESULT_ERROR_OPTION, "nearest");
        barrier(tracer, cmd);
    }
    check_vk(vkEndCommandBuffer_(cmd), "vkEndCommandBuffer");
    submit_and_wait(cmd);
    same_report((const GridwalkReport *)report->data, ALL, 2);

    static float corners[2][3 * (2 * VERTICES + 5)];
    static uint32_t triangles[2][3 * ALL];
    Mesh flat[2], part = *torus;
    part.triangle_count = HALF;
    for (int odd = 0; odd < 2; ++odd) {
        ZERO(flat[odd]);
        flat[odd].corners = corners[odd];
        flat[odd].triangles = triangles[odd];
        for (int i = 0; i < 3; ++i)
            flatten(&flat[odd], i == 0 ? &part : i == 1 ? torus : ground, &record[i], (int)visible[i] & (1 + odd));
    }
    static unsigned char named[RAYS];
    for (int i = 0, moved = 0; i < RAYS; ++i) {
        const uint32_t index = ((const uint32_t *)order->data)[i];
        if (index >= RAYS || named[index]++) fail("the order names each ray once");
        moved += index != (uint32_t)i;
        if (i == RAYS - 1 && !moved) fail("the order is another than the rays'");
    }
    for (int i = 0; i < RAYS; ++i) {
        const GridwalkRay *ray = (const GridwalkRay *)rays->data + i;
        const GridwalkHit *hit[3], *list = (const GridwalkHit *)nearest->data + NEAREST * i;
        for (int k = 0; k < 3; ++k) hit[k] = (const GridwalkHit *)hits[k]->data + i;
        const uint32_t *geometry = (const uint32_t *)geometries->data + 2 * i, found = ((const uint32_t *)counts->data)[i];
        Bounds bounds = {HUGE_VAL, HUGE_VAL, 0, 0};
        brute_force(&flat[i % 2], ray, &bounds);
        if (hit[0]->t < bounds.possible - 1e-4 || hit[0]->t > bounds.sure + 1e-4) differs("distance of records", i, hit[0]->t, &bounds);
        uint32_t triangle = hit[0]->triangle;
        int of = triangle >= first[2] ? 2 : triangle >= first[1];
        if (triangle == GRIDWALK_MISS ? geometry[0] != UINT32_MAX || geometry[1] != UINT32_MAX
                                      : !consistent(&flat[i % 2], ray, hit[0]) || geometry[0] != ids[of] || geometry[1] != triangle - first[of])
            differs("geometry", i, geometry[0], &bounds);
        if (hit[0]->t != (hit[1]->t < hit[2]->t ? hit[1]->t : hit[2]->t)) differs("culled sides", i, hit[1]->t, &bounds);
        if (found < bounds.fewest || found > bounds.most) differs("count of hits", i, found, &bounds);
        if (list[0].triangle != triangle || list[0].t != hit[0]->t) differs("nearest hit", i, list[0].t, &bounds);
        for (uint32_t k = 0; k < NEAREST; ++k)
            if ((list[k].triangle == GRIDWALK_MISS) != (k >= found) || (k > 0 && list[k].t < list[k - 1].t))
                differs("list of hits", i, list[k].t, &bounds);
    }
}

int main(int argc, char **argv) {
    if (argc > 1 && !strcmp(argv[1], "--wrong")) shift = 0.01;
    if (gridwalk_version() != VK_MAKE_API_VERSION(0, GRIDWALK_VERSION_MAJOR, GRIDWALK_VERSION_MINOR, GRIDWALK_VERSION_PATCH))
        fail("header and library are of one version");
    if (gridwalk_last_error()[0] || gridwalk_last_vk_result() != VK_SUCCESS) fail("nothing has failed so far");
    if (!strstr(gridwalk_glsl(), "gridwalk_closest_hit")) fail("the include is a text");
    if (!strstr(gridwalk_slang(), "gridwalk_closest_hit")) fail("the include in Slang is a text");
    make_instance();
    make_device();

    VkPipelineCacheCreateInfo cache_info;
    ZERO(cache_info);
    cache_info.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO;
    VkPipelineCache cache;
    check_vk(vkCreatePipelineCache_(device, &cache_info, NULL, &cache), "vkCreatePipelineCache");
    GridwalkDeviceDesc desc;
    ZERO(desc);
    desc.struct_size = sizeof desc;
    desc.debug_utils = validated ? VK_TRUE : VK_FALSE;
    desc.get_instance_proc_addr = get_instance_proc_addr;
    desc.instance = instance;
    desc.physical_device = physical_device;
    desc.device = device;
    desc.pipeline_cache = cache;
    refuse_descriptions(&desc);
    GridwalkTracer *tracer;
    check(gridwalk_tracer_create(&desc, &tracer), "gridwalk_tracer_create");

    /* Memory: two grids, which share one scratch. */
    GridwalkCapacity capacity = {TRIANGLES, 16 * TRIANGLES, 16 * TRIANGLES, TRIANGLES};
    GridwalkBuildSizes sizes;
    GridwalkRegionSize trace_size;
    check(gridwalk_build_sizes(tracer, &capacity, &sizes), "gridwalk_build_sizes");
    check(gridwalk_trace_scratch_size(tracer, RAYS, &trace_size), "gridwalk_trace_scratch_size");
    Memory *scratch = make_region(sizes.scratch), *trace_scratch = make_region(trace_size);
    Memory *grids[2] = {make_region(sizes.grid), make_region(sizes.grid)};
    Memory *reports[2] = {make_region(sizes.report), make_region(sizes.report)};
    Mesh torus = make_torus(), ground = make_floor();
    Memory *rays = make_memory(RAYS * sizeof(GridwalkRay), 0), *hits = make_memory(RAYS * sizeof(GridwalkHit), 0);
    Memory *both = make_memory(RAYS * sizeof(GridwalkHit), VK_BUFFER_USAGE_TRANSFER_DST_BIT), *any = make_memory(RAYS * 4, 0);
    Memory *counters = make_memory(RAYS * 16, 0), *count = make_memory(4, 0);
    make_rays((GridwalkRay *)rays->data);
    uint32_t fewer = FEWER_RAYS;
    memcpy(count->data, &fewer, 4);

    /* Names of the steps, for the timestamps. */
    char name[64];
    if (sizes.timestamp_count < 2 || sizes.timestamp_count > MAX_STEPS) fail("a build has some steps");
    check(gridwalk_build_step_name(tracer, &capacity, 0, name, sizeof name), "gridwalk_build_step_name");
    char cut[4];
    if (strlen(name) < 4) fail("a step has a name");
    check(gridwalk_build_step_name(tracer, &capacity, 0, cut, sizeof cut), "gridwalk_build_step_name");
    if (strlen(cut) != 3 || strncmp(cut, name, 3)) fail("a name is cut where the room ends");
    refused(gridwalk_build_step_name(tracer, &capacity, sizes.timestamp_count - 1, name, sizeof name), GRIDWALK_RESULT_ERROR_OPTION, "step");

    VkQueryPool queries;
    ZERO(queries);
    if (timestamp_bits) {
        VkQueryPoolCreateInfo info;
        ZERO(info);
        info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
        info.queryType = VK_QUERY_TYPE_TIMESTAMP;
        info.queryCount = sizes.timestamp_count + 3;
        check_vk(vkCreateQueryPool_(device, &info, NULL, &queries), "vkCreateQueryPool");
    }

    /* One command buffer, recorded once and submitted twice. */
    make_commands();
    VkCommandBuffer cmd = begin_commands();

    GridwalkBuildInfo builds[2] = {build_info(&torus, grids[0], scratch, reports[0], capacity),
                                   build_info(&ground, grids[1], scratch, reports[1], capacity)};
    builds[0].timestamp_pool = queries;
    builds[0].first_query = 3;
    builds[1].overlap = GRIDWALK_OVERLAP_BOX;
    builds[1].resolution[0] = 5, builds[1].resolution[1] = 1, builds[1].resolution[2] = 7;
    GridwalkTraceInfo closest = trace_info(rays, hits, trace_scratch, RAYS);
    refuse(tracer, cmd, &builds[0], &closest);

    /* What the host wrote is visible to what is submitted later. The scratch is used by one build after another. */
    for (int i = 0; i < 2; ++i) {
        check(gridwalk_cmd_build(tracer, cmd, &builds[i]), "gridwalk_cmd_build");
        barrier(tracer, cmd);
    }
    /* The torus alone with counters, then the torus and, going on from its hits, the floor; then whether the torus is hit at all. */
    GridwalkTraceInfo traces[4] = {closest, trace_info(rays, both, trace_scratch, RAYS), trace_info(rays, both, trace_scratch, RAYS),
                                   trace_info(rays, any, trace_scratch, RAYS)};
    traces[0].counters = counters->region;
    traces[2].resume = VK_TRUE;
    traces[3].indirect_count = count->region;
    for (int i = 0; i < 4; ++i) {
        VkDeviceAddress grid = grids[i == 2]->region.address;
        check(i == 3 ? gridwalk_cmd_any_hit(tracer, cmd, grid, &traces[i]) : gridwalk_cmd_closest_hit(tracer, cmd, grid, &traces[i]),
              "gridwalk_cmd_closest_hit, gridwalk_cmd_any_hit");
        barrier(tracer, cmd);
    }
    check_vk(vkEndCommandBuffer_(cmd), "vkEndCommandBuffer");

    double hit_count = 0;
    for (int frame = 0; frame < 2; ++frame) {
        place_torus(torus.corners, (float)frame);
        memset(any->data, 0xAB, RAYS * 4);
        submit_and_wait(cmd);

        same_report((const GridwalkReport *)reports[0]->data, TRIANGLES, 0);
        same_report((const GridwalkReport *)reports[1]->data, 4, 2);
        const GridwalkReport *floor_report = (const GridwalkReport *)reports[1]->data;
        if (floor_report->resolution[0] != 5 || floor_report->resolution[1] != 1 || floor_report->resolution[2] != 7)
            fail("a resolution that is asked for is used");
        for (int i = 0; i < RAYS; ++i) {
            const GridwalkRay *ray = (const GridwalkRay *)rays->data + i;
            const GridwalkHit *alone = (const GridwalkHit *)hits->data + i, *nearest = (const GridwalkHit *)both->data + i;
            const uint32_t hit = ((const uint32_t *)any->data)[i];
            Bounds bounds = {HUGE_VAL, HUGE_VAL, 0, 0};
            brute_force(&torus, ray, &bounds);
            hit_count += alone->triangle < TRIANGLES;
            if (alone->t < bounds.possible - 1e-4 || alone->t > bounds.sure + 1e-4) differs("distance", i, alone->t, &bounds);
            if (alone->triangle == GRIDWALK_MISS ? !isinf(alone->t) : !consistent(&torus, ray, alone))
                differs("triangle and barycentrics", i, alone->triangle, &bounds);
            if (i >= FEWER_RAYS ? hit != 0xABABABABu : hit > 1 || (hit ? isinf(bounds.possible) : !isinf(bounds.sure)))
                differs("any hit", i, hit, &bounds);
            if (alone->triangle != GRIDWALK_MISS && ((const uint32_t *)counters->data)[4 * i + 1] == 0)
                differs("a hit without a test", i, alone->triangle, &bounds);
            brute_force(&ground, ray, &bounds);
            if (nearest->t < bounds.possible - 1e-4 || nearest->t > bounds.sure + 1e-4) differs("distance over both", i, nearest->t, &bounds);
        }
    }
    trace_records(tracer, &torus, &ground, rays);
    if (hit_count < RAYS / 2 || hit_count > 2 * RAYS - RAYS / 2) fail("some rays hit and some miss");
    if (timestamp_bits) {
        uint64_t times[MAX_STEPS];
        check_vk(vkGetQueryPoolResults_(device, queries, 3, sizes.timestamp_count, sizeof times, times, 8, VK_QUERY_RESULT_64_BIT),
                 "vkGetQueryPoolResults");
    }

    gridwalk_tracer_destroy(tracer);
    vkDestroyQueryPool_(device, queries, NULL);
    vkDestroyCommandPool_(device, command_pool, NULL);
    vkDestroyPipelineCache_(device, cache, NULL);
    for (int i = 0; i < memory_count; ++i) {
        vkDestroyBuffer_(device, memories[i].region.buffer, NULL);
        vkFreeMemory_(device, memories[i].memory, NULL);
    }
    vkDestroyDevice_(device, NULL);
    if (validated)
        ((PFN_vkDestroyDebugUtilsMessengerEXT)get_instance_proc_addr(instance, "vkDestroyDebugUtilsMessengerEXT"))(instance, messenger, NULL);
    vkDestroyInstance_(instance, NULL);
    if (messages) fail("the validation layer has nothing to say");
    if (wrong) {
        fprintf(stderr, "FAILED: %d comparisons\n", wrong);
        return 1;
    }
    printf("%d rays, %.0f hits in 2 frames, %s\n", RAYS, hit_count, validated ? "validated" : "not validated");
    return 0;
}
