; BROKEN     Twin of 03a_waiting_keeps_the_plan.smt2: every tick begins a new reaction time for
;            the old command.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const b Real)        ; least braking, told to rest
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const s Real)        ; robot's own way since the thing was seen
(declare-const age Real)      ; time since the thing was seen
(declare-const d Real)        ; clearance when the thing was seen
(declare-const w Real)        ; greatest speed until the robot begins to brake
(declare-const rho Real)      ; what is left of the reaction time
(declare-const t Real)        ; time that passes
(declare-const x Real)        ; robot's own way meanwhile
; Formulas
(define-fun plan_need ((s Real) (age Real) (rho Real)) Real
  (+ (* kappa (+ s (* w rho) (/ (* w w) (* 2 b)))) (* V (+ age rho (/ w b)))))

; Assumptions
(assert (> b 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= s 0))
(assert (>= age 0))
(assert (>= w 0))
(assert (>= rho 0))
(assert (>= t 0))
(assert (>= x 0))
(assert (<= t rho))
(assert (<= x (* w t)))
(assert (<= (plan_need s age rho) d))

; Conclusion, negated
(assert (not (<= (plan_need (+ s x) (+ age t) rho) d)))      ; BROKEN: rho is not used up
(check-sat)
