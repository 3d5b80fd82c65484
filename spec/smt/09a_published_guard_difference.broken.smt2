; BROKEN     Twin of 09a_published_guard_difference.smt2: the speed that is gained in the reaction
;            time is forgotten.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const A Real)        ; greatest acceleration
(declare-const b Real)        ; least braking, told to rest
(declare-const eps Real)      ; reaction time
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const c Real)        ; commanded speed
(declare-const u Real)        ; bound of the robot's present speed
; Formulas, times 2b (00)
(define-fun need_2b ((w Real)) Real
  (+ (* kappa (+ (* 2 b s) (* 2 b w eps) (* w w))) (* 2 V (+ (* b age) (* b eps) w))))
(define-fun fastest ((c Real) (u Real)) Real c)              ; BROKEN: no gain
(define-fun published_2b ((v Real)) Real
  (+ (* v v) (* 2 V v) (* (+ A b) (+ (* A eps eps) (* 2 eps (+ v V))))))

; Assumptions
(assert (>= A 0))
(assert (> b 0))
(assert (> eps 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= c 0))
(assert (>= u 0))
(assert (and (= kappa 1) (= s 0) (= age 0)))
(assert (<= u (+ c (* A eps))))

; Conclusion, negated
(assert (not (= (need_2b (fastest c u)) (+ (published_2b c) (* b A eps eps)))))
(check-sat)
