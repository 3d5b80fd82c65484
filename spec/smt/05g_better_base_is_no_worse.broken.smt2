; BROKEN     Twin of 05g_better_base_is_no_worse.smt2: the brakes are weaker.
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
(declare-const A1 Real)       ; acceleration of the better base
(declare-const b1 Real)       ; braking of the better base
(declare-const eps1 Real)     ; reaction time of the better base
; Formulas
(define-fun way_to_rest ((w Real) (b Real) (eps Real)) Real (+ (* w eps) (/ (* w w) (* 2 b))))
(define-fun time_to_rest ((w Real) (b Real) (eps Real)) Real (+ eps (/ w b)))
(define-fun need ((A Real) (b Real) (eps Real) (w Real)) Real
  (+ (* kappa (+ s (way_to_rest w b eps))) (* V (+ age (time_to_rest w b eps)))))
(define-fun fastest ((A Real) (eps Real)) Real (ite (>= (+ c (* A eps)) u) (+ c (* A eps)) u))

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
(assert (>= A1 0))
(assert (> b1 0))
(assert (>= eps1 0))
(assert (<= (need A b eps (fastest A eps)) d))
(assert (<= A1 A))
(assert (<= b1 b))                                           ; BROKEN: turned round
(assert (<= eps1 eps))

; Conclusion, negated
(assert (not (<= (need A1 b1 eps1 (fastest A1 eps1)) d)))
(check-sat)
