#pragma once

// Embree 3 and Embree 4 by the same calls. KROK_EMBREE_MAJOR comes from the build, which takes what
// is installed. Rays and results are Embree's own structs, which both versions share.

#if KROK_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace krok::embree {

#if KROK_EMBREE_MAJOR >= 4
// What a callback of a user geometry or a filter is handed through.
using Context = RTCRayQueryContext;

inline void init(Context& context) {
  rtcInitRayQueryContext(&context);
}

// The nearest hit. `coherent`: the next rays are much like this one, which is faster if true.
inline void intersect(RTCScene scene, Context& context, RTCRayHit& ray, bool coherent = false) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = &context;
  if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect1(scene, &ray, &arguments);
}

// Whether anything is hit: ray.tfar is below 0 afterwards.
inline void occluded(RTCScene scene, Context& context, RTCRay& ray) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &context;
  rtcOccluded1(scene, &ray, &arguments);
}
#else
using Context = RTCIntersectContext;

inline void init(Context& context) {
  rtcInitIntersectContext(&context);
}

inline void intersect(RTCScene scene, Context& context, RTCRayHit& ray, bool coherent = false) {
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect1(scene, &context, &ray);
}

inline void occluded(RTCScene scene, Context& context, RTCRay& ray) {
  rtcOccluded1(scene, &context, &ray);
}
#endif

}  // namespace krok::embree
